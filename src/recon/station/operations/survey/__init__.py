"""Surveys, live: asked for, planned by the worker, started by a person's word, carried on by ticks.

`record` is what is known, `words` what people say to a survey, `planning` how rows come about,
`carrying` how missions come out of it, `crew` who can fly, `observing` what is seen, `told` and
`audited` what is told. A survey lives as long as this run: after a restart nothing goes on.
"""

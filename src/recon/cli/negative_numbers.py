"""Negative numbers as arguments: half of the world's longitudes look like options to a shell."""

import re
from typing import Any

from typer.core import TyperCommand

NUMBER = re.compile(r"-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


class TakesNegativeNumbers(TyperCommand):
    """A command whose arguments may be negative numbers, without a `--` before them.

    Any other word that begins with a hyphen and is no option is refused as ever.
    """

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Take what is no option for an argument when it can be nothing but a number.

        `ctx` is a context of click, of whichever click typer brings.
        """
        known = {"--", *ctx.help_option_names}
        known.update(word for param in self.params for word in param.opts)
        odd = [a for a in args if a.startswith("-") and a.partition("=")[0] not in known]
        ctx.ignore_unknown_options = all(NUMBER.fullmatch(word) for word in odd)
        return super().parse_args(ctx, args)

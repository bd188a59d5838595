"""Runs the guide's first example unchanged with a real station."""

import ast
import re
from pathlib import Path
from types import CodeType

import pytest
from tests.client.running_station import running_station
from tests.patient_loop import run_patiently

GUIDE = Path(__file__).parents[2] / "docs/how-to/fly-from-python.md"
BLOCKS = re.findall(r"```python\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)


def compiled(block: str) -> CodeType:
    return compile(block, str(GUIDE), "exec", ast.PyCF_ALLOW_TOP_LEVEL_AWAIT)


@pytest.mark.parametrize("block", BLOCKS)
def test_every_block_is_python(block: str) -> None:
    assert compiled(block).co_code


def test_the_first_block_holds_a_vehicle(capsys: pytest.CaptureFixture[str]) -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url:
            await eval(compiled(BLOCKS[0].replace("http://127.0.0.1:8080", url)), {})

    run_patiently(main())
    assert "done" in capsys.readouterr().out

"""What CI decides: the step for the companion app, what has changed lately, commit subjects."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SKIPPED = "core and adapter of the companion app were NOT tested"
UNREACHABLE = "Could not transfer artifact org.junit:junit-bom:pom:5.14.4 from/to central"


def step(folder: Path, **tools: str) -> subprocess.CompletedProcess[str]:
    """Run the step where `java` and `mvn` are these shell scripts, or are missing."""
    # The rest of the system, without its own Maven and Java.
    for name in ("sh", "make", "mktemp", "rm", "tee", "grep", "awk", "head", "cat"):
        (folder / name).symlink_to(Path("/usr/bin") / name)
    for name, script in tools.items():
        (folder / name).write_text(f"#!/bin/sh\n{script}\n")
        (folder / name).chmod(0o755)
    return subprocess.run(
        ["tools/ci_android_core.sh"],
        cwd=ROOT,
        env={**os.environ, "PATH": str(folder), "MAKEFLAGS": ""},
        capture_output=True,
        text=True,
        check=False,
    )


JAVA = """echo 'openjdk version "17.0.15" 2025-04-15' >&2"""


@pytest.mark.parametrize(
    ("tools", "reason"),
    [
        ({}, "JDK 17 and Maven are needed"),
        ({"java": JAVA}, "JDK 17 and Maven are needed"),
        (
            {"java": JAVA.replace("17.0", "11.0"), "mvn": "exit 0"},
            "JDK 17 and Maven are needed",
        ),
        ({"java": JAVA, "mvn": f"echo '{UNREACHABLE}'; exit 1"}, "cannot reach Maven Central"),
    ],
)
def test_it_is_left_out_with_a_sentence(tmp_path: Path, tools: dict[str, str], reason: str) -> None:
    done = step(tmp_path, **tools)
    assert done.returncode == 0, done.stderr
    assert SKIPPED in done.stdout
    assert reason in done.stdout


def test_a_build_that_passes_or_fails_decides(tmp_path: Path) -> None:
    passing, failing = tmp_path / "passing", tmp_path / "failing"
    for folder in (passing, failing):
        folder.mkdir()
    done = step(passing, java=JAVA, mvn='echo "run: $*"')
    assert done.returncode == 0, done.stderr
    assert "run: --batch-mode --quiet --file android/pom.xml verify" in done.stdout
    assert SKIPPED not in done.stdout
    failed = step(failing, java=JAVA, mvn="echo 'There are test failures'; exit 1")
    assert failed.returncode == 1
    assert "There are test failures" in failed.stdout
    assert SKIPPED not in failed.stdout


def test_ci_takes_the_steps() -> None:
    run = (ROOT / ".ci/run").read_text()
    assert "tools/changed_lately.sh android vectors; then\n    tools/ci_android_core.sh\n" in run
    assert "tools/changed_lately.sh src/recon/safety tests/safety && echo coverage-safety" in run
    assert (
        "tools/changed_lately.sh crates fuzz vectors Cargo.toml Cargo.lock && echo test-rust" in run
    )


def git(folder: Path, *words: str) -> str:
    """Run git without the configuration of this machine."""
    name = ("-c", "user.name=test", "-c", "user.email=test@localhost")
    environment = {**os.environ, "GIT_CONFIG_GLOBAL": os.devnull}
    return subprocess.run(
        ["git", *name, *words],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    ).stdout


def test_a_folder_has_changed_when_one_of_fifty_commits_changed_it_or_nothing_is_known(
    tmp_path: Path,
) -> None:
    def has_changed() -> bool:
        words = ROOT / "tools/changed_lately.sh", "src/recon/safety", "tests/safety"
        return not subprocess.run(words, cwd=tmp_path).returncode

    def commits(count: int) -> None:
        for _ in range(count):
            git(tmp_path, "commit", "--allow-empty", "--quiet", "--message", "docs: something")

    assert has_changed()  # no repository
    git(tmp_path, "init", "--quiet")
    assert has_changed()  # no commit
    commits(50)
    assert has_changed()  # a shallow clone may look like this
    commits(1)
    assert not has_changed()
    gate = tmp_path / "src/recon/safety/gate.py"
    gate.parent.mkdir(parents=True)
    gate.write_text("")
    assert has_changed()
    git(tmp_path, "add", ".")
    commits(50)
    assert has_changed()
    commits(1)
    assert not has_changed()


LAST_OF_FREE_LENGTH = "75d6b0daaf4daead93bf8e80577d0d34c8223a46"
SUBJECT_CHARACTERS = 72


def test_commit_subjects_are_short() -> None:
    """Those since the rule is checked; of a shallow clone, those that it holds."""
    if not (ROOT / ".git").exists():
        pytest.skip("not a git repository")
    known = git(ROOT, "rev-list", "HEAD").split()
    since = [f"^{LAST_OF_FREE_LENGTH}"] if LAST_OF_FREE_LENGTH in known else []
    subjects = git(ROOT, "log", "--no-merges", "--format=%s", "HEAD", *since).splitlines()
    assert [each for each in subjects if len(each) > SUBJECT_CHARACTERS] == []

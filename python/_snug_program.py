"""The command `snug` of the wheel: the program that the wheel brings takes the place of this process.

A module of its own beside the package, so that the command does not wait for numpy.
"""
import os
import sys


def main() -> None:
    """Runs the program with the words of the command line. Agents in Python (`--agent module:Class`) are run by this interpreter."""
    program = os.path.join(os.path.dirname(os.path.abspath(__file__)), "snug", "bin", "snug")
    os.environ.setdefault("SNUG_PYTHON", sys.executable)
    try:
        os.execv(program, ["snug", *sys.argv[1:]])
    except OSError as error:
        sys.exit(f"snug: {program}: {error.strerror}: expected the program of the wheel; install it again")

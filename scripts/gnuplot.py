"""What the plots of this folder share: how gnuplot is told, and how runs are named."""

import os
import subprocess
import sys

PICTURE_SIZE = "1000,{height}"


def quoted(text):
    """A text as gnuplot's single-quoted string."""
    return "'" + str(text).replace("'", "''") + "'"


def pictures(out, height, commands):
    """A script that draws the same commands as OUT.svg and OUT.png, 1000 pixels wide."""
    size = PICTURE_SIZE.format(height=height)
    return "\n".join([
        f"set terminal svg size {size} dynamic background rgb 'white'", f"set output {quoted(out + '.svg')}", commands,
        f"set terminal pngcairo size {size}", f"set output {quoted(out + '.png')}", commands, "unset output", ""])


def run(program, script):
    """Has gnuplot draw; ends `program` with a sentence when that fails."""
    try:
        subprocess.run(["gnuplot"], input=script, text=True, check=True)
    except FileNotFoundError:
        sys.exit(f"{program}: gnuplot is missing (Debian package gnuplot-nox)")
    except subprocess.CalledProcessError as failure:
        sys.exit(f"{program}: gnuplot failed with exit code {failure.returncode}")


def names_of(runs):
    """What the runs' directories are called, without what all their names begin with."""
    if len(runs) == 1:
        return [runs[0].name]
    shared = os.path.commonprefix([path.name for path in runs])
    return [path.name.removeprefix(shared) or path.name for path in runs]

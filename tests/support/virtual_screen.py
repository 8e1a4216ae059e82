"""A virtual screen for a program that draws."""
import contextlib
import os
import subprocess


@contextlib.contextmanager
def virtual_screen():
    """Yields the environment of a program that draws: an Xvfb on a free display, and OpenGL in software.

    The server keeps its state between clients (-noreset). That of xvfb-run restarts when the last client leaves, and refuses
    the next client meanwhile, which made ParaView fail in 3 of 16 runs. Raises OSError if Xvfb (Debian: xvfb) is not
    installed or does not start.
    """
    command = ["Xvfb", "-displayfd", "1", "-screen", "0", "1600x1000x24", "-nolisten", "tcp", "-noreset"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as server:
        try:
            number = server.stdout.readline().strip()
            if not number:
                raise OSError("Xvfb did not start")
            yield {**os.environ, "DISPLAY": f":{number}", "LIBGL_ALWAYS_SOFTWARE": "1"}
        finally:
            server.terminate()

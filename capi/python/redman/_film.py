"""Films of pictures, by the program ffmpeg."""
from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path
from typing import Iterable

from ._error import FileError, UnsupportedError
from ._rows import Array

_FILTERS = {  # one palette for a whole GIF; an even size is what H.264 needs
    ".gif": ["-vf", "fps=20,split[a][b];[a]palettegen[p];[b][p]paletteuse"],
    ".mp4": ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,format=yuv420p", "-c:v", "libx264", "-crf", "18", "-movflags", "+faststart"]}


def film(path: Path, pictures: Iterable[Array], frames_per_second: float) -> None:
    """Writes an .mp4 or .gif of pictures [height][width][3], which are made while it is written."""
    process = None
    with tempfile.TemporaryFile() as said:
        try:
            for picture in pictures:
                if process is None:
                    size = f"{picture.shape[1]}x{picture.shape[0]}"
                    command = ["ffmpeg", "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size,
                               "-r", f"{frames_per_second:.6g}", "-i", "-", *_FILTERS[path.suffix.lower()], f"file:{path}"]
                    try:
                        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=said)
                    except FileNotFoundError:
                        raise UnsupportedError(f"render: a {path.suffix} file needs the program ffmpeg, which is not on PATH "
                                               "(apt-get install ffmpeg); .html and .png need nothing") from None
                assert process.stdin is not None
                process.stdin.write(picture.tobytes())
        except BrokenPipeError:
            pass  # it says below why it ended
        finally:
            if process is not None and process.stdin is not None:
                try:
                    process.stdin.close()
                except BrokenPipeError:
                    pass
                process.wait()
        if process is not None and process.returncode:
            said.seek(0)
            lines = said.read().decode(errors="replace").strip().splitlines()
            raise FileError(f"render {path}: ffmpeg: {lines[-1] if lines else f'ended with {process.returncode}'}")

"""The window of a `Viewer`, as a program: shows the PPM pictures that come on its input.

It ends with its input or when its window is closed. It needs nothing but tkinter, which Debian
packs apart from Python. The reason of a failed start is its last line on standard error.
"""

import os
import re
import sys

CANNOT_SHOW = 3
"""Exit code where there is no toolkit or no display."""
_HEADER = re.compile(rb"P6 (\d{1,5}) (\d{1,5}) 255\n")
_INPUT = 0
_CHUNK = 1 << 20


class Pictures:
    """Cuts a stream of bytes into PPM pictures."""

    def __init__(self) -> None:
        self._bytes = bytearray()

    def add(self, data: bytes) -> bytes | None:
        """The last picture that is whole now, if any; those before it came too late to be shown.

        Raises `ValueError` for something else than a picture.
        """
        self._bytes += data
        picture = None
        while size := self._size():
            if len(self._bytes) < size:
                break
            picture = bytes(self._bytes[:size])
            del self._bytes[:size]
        return picture

    def _size(self) -> int:
        """Return the size of the current picture, header included.

        0 while its header is incomplete.
        """
        header = _HEADER.match(self._bytes)
        if header is None:
            if b"\n" in self._bytes or len(self._bytes) > 20:
                raise ValueError("not a picture")
            return 0
        return header.end() + 3 * int(header[1]) * int(header[2])


def main() -> int:
    """Show pictures until there are no more."""
    try:
        import tkinter
    except ImportError:
        return _cannot("this Python has no tkinter (on Debian: apt install python3-tk)")
    try:
        root = tkinter.Tk()
    except tkinter.TclError as error:
        return _cannot(str(error))
    root.title(sys.argv[1] if len(sys.argv) > 1 else "EdgeVox")
    root.resizable(width=False, height=False)
    image = tkinter.PhotoImage(master=root)
    tkinter.Label(root, image=image, borderwidth=0).pack()
    pictures = Pictures()

    def read(_file: object, _mask: int) -> None:
        data = os.read(_INPUT, _CHUNK)
        if not data:
            root.destroy()
        elif picture := pictures.add(data):
            image.configure(data=picture, format="ppm")

    root.createfilehandler(_INPUT, tkinter.READABLE, read)
    root.mainloop()
    return 0


def _cannot(reason: str) -> int:
    print(reason, file=sys.stderr)  # noqa: T201 - the one who started it reads it
    return CANNOT_SHOW


if __name__ == "__main__":
    sys.exit(main())

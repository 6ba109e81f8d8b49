"""Probes that the doctor's tests run in processes of their own: good ones and bad ones."""

import os
import signal
import time


def hangs():
    time.sleep(60)


def dies():
    os.kill(os.getpid(), signal.SIGSEGV)


def chats():
    os.write(1, b"ALSA lib: chatter\n")
    return {"seen": 1}


def raises():
    raise OSError("no such device")

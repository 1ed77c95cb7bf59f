"""A controller in the process of the user: the coordinator's connection to its controller program is handed on to this process."""
import json
import os
import pathlib
import shlex
import shutil
import socket
import sys
import tempfile
import threading
import time
from typing import Any, Callable, List, Optional

from tandem.entries import SceneError, nearest

# Hands its standard input, which is the coordinator's socket, to the process of the user, and stays until that closes the connection:
# the messages of a window then pass through no other process.
_DOORMAN = "import socket,sys;s=socket.socket(socket.AF_UNIX);s.connect(sys.argv[1]);socket.send_fds(s,[b'c'],[0]);s.recv(1)"


class FunctionController:
    """Serves one run: `function(time, sensors)` is called in a thread of this process before each window."""

    def __init__(self, function: Callable[[float, dict], Any]):
        self.function = function
        self.error: Optional[BaseException] = None
        self.calls: List[float] = []  # from the receipt of a question to its answer, not yet sent [s], if `timed`
        self.timed = bool(os.environ.get("TANDEM_TIME_CONTROLLER"))
        self._folder = tempfile.mkdtemp(prefix="tandem_control_")
        self._path = str(pathlib.Path(self._folder) / "door")
        self._door = socket.socket(socket.AF_UNIX)
        self._door.bind(self._path)
        self._door.listen(1)
        self._guest: Optional[socket.socket] = None
        self._thread = threading.Thread(target=self._serve, name="tandem controller", daemon=True)
        self._thread.start()

    @property
    def command(self) -> str:
        """What `tandem run --controller` gets."""
        return shlex.join([sys.executable, "-S", "-E", "-c", _DOORMAN, self._path])

    def close(self) -> None:
        """After the end of the run."""
        for end in (self._door, self._guest):
            if end is not None:
                try:
                    end.shutdown(socket.SHUT_RDWR)
                except OSError:
                    pass
                end.close()
        self._thread.join(5)
        shutil.rmtree(self._folder, ignore_errors=True)

    def _serve(self) -> None:
        try:
            self._guest, _ = self._door.accept()
            _, descriptors, _, _ = socket.recv_fds(self._guest, 1, 1)
            with socket.socket(fileno=descriptors[0]) as line:
                self._loop(line)
        except OSError:
            pass  # the run has ended
        except BaseException as error:  # noqa: B902 (it is raised again where the user waits)
            self.error = error
        finally:
            if self._guest is not None:
                self._guest.close()

    def _loop(self, line: socket.socket) -> None:
        loads, function, receive, send = json.loads, self.function, line.recv, line.sendall
        pending = b""
        inputs: Optional[List[str]] = None
        while True:
            while b"\n" not in pending:
                more = receive(1 << 16)
                if not more:
                    return
                pending = pending + more if pending else more
            begin = time.perf_counter() if self.timed else 0.0
            text, _, pending = pending.partition(b"\n")
            message = loads(text)
            if inputs is None:
                inputs = message["inputs"]
                continue
            answer = function(message["time"], message["sensors"])
            if not isinstance(answer, dict) or len(answer) != len(inputs):
                answer = _checked(answer, inputs)
            try:
                reply = ('{"inputs": {' + ", ".join([f'"{name}": {float(answer[name])!r}' for name in inputs]) + "}}\n").encode()
            except KeyError:
                _checked(answer, inputs)
            if self.timed:  # before it is sent: that lets the coordinator run, perhaps on this core
                self.calls.append(time.perf_counter() - begin)
            send(reply)


def _checked(answer: Any, inputs: List[str]) -> dict:
    """A number is the value of the only input; all else is an error that names what is missing."""
    if not isinstance(answer, dict) and hasattr(answer, "__float__") and len(inputs) == 1:
        return {inputs[0]: answer}
    names = ", ".join(f"'{name}'" for name in inputs)
    if not isinstance(answer, dict):
        raise SceneError(f"the controller returned {answer!r}", hint=f"return a dict with a number for {names}", made_at="the controller")
    for name in answer:
        if name not in inputs:
            raise SceneError(f"the controller returned '{name}', which is no control input" + nearest(name, inputs), made_at="the controller")
    missing = next(name for name in inputs if name not in answer)
    raise SceneError(f"the controller returned no '{missing}'", hint=f"return a dict with a number for {names}", made_at="the controller")

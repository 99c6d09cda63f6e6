"""The local server: the studio, the crowd and its report, for this machine alone."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest

from conftest import crowdquilt
from crowdquilt import server

needs_studio = pytest.mark.skipif(
    not (server.STUDIO / "index.html").exists(), reason="the studio is not built: run `make studio`"
)


@pytest.fixture
def url(walkers: Path) -> Iterator[str]:
    """The address of a running `crowdquilt view`."""
    command = [sys.executable, "-u", "-m", "crowdquilt", "view", str(walkers), "--no-open"]
    running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert running.stdout is not None
    told = running.stdout.readline()
    found = re.search(r"http://127\.0\.0\.1:\d+/", told)
    assert found, told + running.communicate(timeout=5)[1]
    yield found[0]
    running.send_signal(signal.SIGINT)
    _, errors = running.communicate(timeout=10)
    assert "Traceback" not in errors


@needs_studio
def test_page_crowd_and_report(url: str, walkers: Path) -> None:
    with urllib.request.urlopen(url) as page:
        text = page.read().decode()
        assert page.headers.get_content_type() == "text/html" and "<script" in text
    script = re.search(r'src="\./([^"]+\.js)"', text)
    assert script, text
    with urllib.request.urlopen(url + script[1]) as code:
        assert "javascript" in code.headers.get_content_type()
    with urllib.request.urlopen(url + "data/crowd.crowd") as crowd:
        assert crowd.read() == walkers.read_bytes()
        assert crowd.headers["Cache-Control"] == "no-store"
    with urllib.request.urlopen(url + "data/report.json") as report:
        assert json.load(report)["characters"] == 3


@needs_studio
def test_other_names_and_paths_are_refused(url: str) -> None:
    # A page elsewhere that resolves its own name to this machine asks with that name.
    foreign = urllib.request.Request(url + "data/crowd.crowd", headers={"Host": "evil.example"})
    for request, code in ((foreign, 400), (urllib.request.Request(url + "../../etc/passwd"), 404)):
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(request)
        assert refused.value.code == code


@needs_studio
def test_a_port_in_use_is_told(url: str, walkers: Path) -> None:
    port = url.rsplit(":", 1)[1].strip("/")
    done = crowdquilt("view", walkers, "--no-open", "--port", port, timeout=30)
    assert done.returncode == 2 and f"port {port}" in done.stderr


def test_the_report_beside_the_crowd_is_used_while_it_is_newer(tmp_path: Path, walkers: Path) -> None:
    beside = walkers.with_name("report.json")
    beside.write_text('{"mine": 1}')
    assert json.loads(server.report_of(walkers)) == {"mine": 1}
    import os

    os.utime(beside, (1, 1))
    assert json.loads(server.report_of(walkers))["characters"] == 3

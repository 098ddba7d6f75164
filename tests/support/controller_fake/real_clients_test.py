"""A client that others drive real arms with, ur_rtde, takes the fake for a controller.

CONTROLLER_FAKE names the program; ur_rtde insists on the standard ports, so each run of the fake
has a loopback address of its own.
"""

import importlib.util
import os
import subprocess
import time

import pytest

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("rtde_control") is None or "CONTROLLER_FAKE" not in os.environ,
    reason="needs ur_rtde (pip install ur-rtde==1.6.5) and CONTROLLER_FAKE",
)

SPEED_LIMITS_RADPS = [2.0944, 2.0944, 3.1416, 3.1416, 3.1416, 3.1416]
PERIOD_S = 0.008


class Fake:
    def __init__(self):
        number = os.getpid()
        self.address = f"127.{1 + number // 65536 % 200}.{number // 256 % 256}.{2 + number % 250}"
        self.process = subprocess.Popen(
            [os.environ["CONTROLLER_FAKE"], "--lenient", "--address", self.address],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self.process.stdout.readline().startswith("controller fake on")

    def command(self, line):
        """Returns when it has been done."""
        self.process.stdin.write(line + "\nstatus\n")
        self.process.stdin.flush()
        self.process.stdout.readline()

    def lines(self, command):
        """What the fake prints up to the line `<command> end`."""
        self.process.stdin.write(command + "\n")
        self.process.stdin.flush()
        lines = []
        while (line := self.process.stdout.readline()) and line != f"{command} end\n":
            lines.append(line.rstrip("\n"))
        return lines

    def joints(self):
        rows = [line.split()[2:] for line in self.lines("trace")]
        return [[float(number) for number in row] for row in rows]

    def close(self):
        self.process.stdin.close()
        self.process.wait(10)


@pytest.fixture
def fake():
    controller = Fake()
    yield controller
    controller.close()


def wait_until(condition, seconds=5):
    """The two interfaces have connections of their own: one may be frames behind the other."""
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.01)
    return condition()


def largest_speed_share(joints):
    return max(
        abs(after[i] - before[i]) / PERIOD_S / SPEED_LIMITS_RADPS[i]
        for before, after in zip(joints, joints[1:]) for i in range(6))


def test_receive(fake):
    from rtde_receive import RTDEReceiveInterface

    receive = RTDEReceiveInterface(fake.address)
    assert receive.isConnected()
    assert receive.getActualQ() == pytest.approx([-1.8476, -1.6540, 2.1158, -2.0326, -1.5708, -1.8476])
    assert receive.getRobotMode() == 7
    assert receive.getSafetyMode() == 1
    assert receive.getTargetSpeedFraction() == 1
    before = receive.getTimestamp()
    fake.command("slider 0.3")
    fake.command("protect")
    assert wait_until(lambda: receive.getSafetyMode() == 3)
    assert receive.isProtectiveStopped()
    assert receive.getTargetSpeedFraction() == pytest.approx(0.3)
    assert receive.getTimestamp() > before
    receive.disconnect()


def test_dashboard(fake):
    from dashboard_client import DashboardClient

    dashboard = DashboardClient(fake.address)
    dashboard.connect()
    assert dashboard.isConnected()
    assert "RUNNING" in dashboard.robotmode()
    assert "NORMAL" in dashboard.safetymode()
    assert dashboard.getRobotModel() == "UR10"
    assert dashboard.polyscopeVersion().startswith("3.15.8")
    assert not dashboard.running()
    fake.command("protect")
    dashboard.unlockProtectiveStop()
    dashboard.disconnect()


def test_control(fake):
    from rtde_control import RTDEControlInterface
    from rtde_receive import RTDEReceiveInterface

    control = RTDEControlInterface(fake.address)
    receive = RTDEReceiveInterface(fake.address)
    assert control.isProgramRunning()

    target = [-1.2, -1.5, 1.9, -1.9, -1.5708, -1.6]
    assert control.moveJ(target, 3.0, 10.0)
    assert wait_until(lambda: receive.getActualQ() == pytest.approx(target, abs=1e-6))

    pose = receive.getActualTCPPose()
    pose[0] += 0.08
    pose[2] += 0.05
    assert control.moveL(pose, 0.25, 1.2)
    assert wait_until(lambda: receive.getActualTCPPose()[:3] == pytest.approx(pose[:3], abs=1e-6))

    assert control.moveJ(target, 1.0, 1.4, True)  # asynchronous, and stopped on the way
    control.stopJ(4.0)
    assert wait_until(lambda: max(map(abs, receive.getActualQd())) < 1e-3)

    assert control.speedJ([0.2, 0, 0, 0, 0, 0], 1.0, 0.4)
    assert control.speedStop()
    assert control.getInverseKinematics(pose) == pytest.approx(
        control.getInverseKinematics(pose, receive.getActualQ()), abs=1e-6)
    control.stopScript()

    assert largest_speed_share(fake.joints()) <= 1.0001
    scripts = fake.lines("scripts")
    assert any("def rtde_control():" in line for line in scripts)
    assert not [line for line in scripts if line.startswith("fault")]
    control.disconnect()
    receive.disconnect()

"""What each client of other people does with an arm, run by the Python of its own environment; `argv[1]` is the port.

A script that ends without an error has found the arm to do all that it must do for this client.
"""

PYDOBOTLAB = """
import sys, time
from pydobotlab import Magician
from pydobotlab.errors import DobotKinematicError
arm = Magician(port=sys.argv[1], require_panel=False, via_broker=False, verbose=False)
arm.connect()
def place():
    return [round(value, 1) for value in arm.get_pose().as_xyzr()[:3]]
assert place() == [200.0, 0.0, 50.0], place()
assert arm.get_device_serial_number() == "SIMULATED-ARM"
arm.set_device_name("a1")
assert arm.get_device_name() == "a1"
assert arm.get_device_version() == (3, 7, 0)
targets = [(220, 10, 40), (225, 10, 40), (220, 10, 40), (5, 25, 35), (0, 20, 30), (5, 22, 33), (1, 1, 1), (2, 2, 2),
           (1, 1, 1), (220, 0, 40)]
for mode, target in enumerate(targets):
    assert arm.ptp(mode, *target, 5), mode
assert place() == [220.0, 0.0, 40.0], place()
arm.move_to(250, 0, 50, wait=True)
assert place() == [250.0, 0.0, 50.0], place()
arm.set_cp_params(100, 60, 80)
arm.cp(210, 5, 20, velocity=60)
arm.cp(1, -2, 0.5, velocity=60, mode=0)
arm.wait_idle()
assert place() == [211.0, 3.0, 20.5], place()
arm.set_home()
assert place() == [200.0, 0.0, 50.0], place()
arm.wait(0.1)
arm.motion_params = 100, 80
assert arm.motion_params == (100, 80)
arm.jump_params = 100, 20
assert arm.jump_params == (100, 20)
arm.set_jog_common_params(30, 30)
arm.jog(1)
time.sleep(0.3)
arm.jog_stop()
assert place()[0] > 201.0, place()
arm.stop_queue()
arm.move_to(230, 0, 50, wait=False)
assert arm.queued_cmd_left_space() == 31
arm.force_stop_queue()
arm.clear_queue()
assert arm.queued_cmd_left_space() == 32
arm.start_queue()
before = arm.queued_cmd_current_index()
arm.wait(0.05)
assert arm.queued_cmd_current_index() > before
try:
    arm.move_to(20, 40, 50, wait=True)
except DobotKinematicError:
    pass
else:
    raise SystemExit("a target out of reach was taken")
arm.clear_alarm()
assert not arm.get_alarms()
arm.disconnect()
"""

PYDOBOTPLUS = """
import sys, time
from pydobotplus import Dobot
from pydobotplus.dobotplus import MODE_PTP
arm = Dobot(port=sys.argv[1])
def place():
    position = arm.get_pose().position
    return [round(value, 1) for value in (position.x, position.y, position.z)]
assert place() == [200.0, 0.0, 50.0], place()
arm.move_to(x=250, y=0, z=50, r=0, wait=False)
arm.move_to(x=250, y=10, z=50, r=0, wait=True)
assert place() == [250.0, 10.0, 50.0], place()
arm.move_to(x=230, y=0, z=30, r=0, mode=MODE_PTP.MOVL_XYZ, wait=True)
assert place() == [230.0, 0.0, 30.0], place()
arm.speed(100, 100)
arm.suck(True)
arm.suck(False)
arm.grip(True)
arm._set_cp_params(100, 60, 80)
arm._set_cple_cmd(210, 5, 20, 40, absolute=True)
arm.home()
time.sleep(2.5)
assert place() == [200.0, 0.0, 50.0], place()
assert arm.get_alarms() == set()
arm.move_to(x=20, y=40, z=50, r=0, wait=False)
time.sleep(0.3)
assert len(arm.get_alarms()) == 1
arm._set_queued_cmd_clear()
arm.clear_alarms()
assert arm.get_alarms() == set()
arm.close()
"""

PYDOBOT = """
import sys, time
from pydobot import Dobot
arm = Dobot(port=sys.argv[1], verbose=False)
def place():
    return [round(value, 1) for value in arm.pose()[:3]]
assert place() == [200.0, 0.0, 50.0], place()
arm.move_to(250, 0, 50, 0, wait=True)
assert place() == [250.0, 0.0, 50.0], place()
arm.suck(True)
arm.suck(False)
arm.grip(True)
arm.grip(False)
arm.speed(100., 100.)
arm.wait(100)
arm.move_to(218.5, 0, 50, 0)  # its checksum is wrong, as is the next one's
arm.move_to(219.5, 0, 50, 0)
time.sleep(0.5)
assert place() == [250.0, 0.0, 50.0], "two packets with a wrong checksum were taken"
arm.close()
"""

DOBOTWRAPPERPY = """
import sys, threading
from dobotWrapperPy.dobotapi import DobotApi
from dobotWrapperPy.dobotConnection import DobotConnection
from dobotWrapperPy.enums.CPMode import CPMode
from dobotWrapperPy.enums.ptpMode import PTPMode
from dobotWrapperPy.enums.realTimeTrack import RealTimeTrack
from dobotWrapperPy.paramsStructures import tagCPCmd, tagCPParams, tagHomeCmd, tagPTPCmd, tagWAITCmd
arm = DobotApi(DobotConnection(sys.argv[1]))
arm.initialize_robot()
def place():
    pose = arm.get_pose()
    return [round(value, 1) for value in (pose.x, pose.y, pose.z)]
assert place() == [200.0, 0.0, 50.0], place()
arm.set_ptp_cmd(tagPTPCmd(PTPMode.MOVL_XYZ, 220, 10, 40, 5), wait=True, is_queued=True)
assert place() == [220.0, 10.0, 40.0], place()
track = next(iter(RealTimeTrack))
arm.set_cp_params(tagCPParams(100, 60, 80, track), wait=True, is_queued=True)
arm.set_cp_cmd(tagCPCmd(CPMode.ABSOLUTE, 210, 5, 20, 60), wait=True, is_queued=True)
assert place() == [210.0, 5.0, 20.0], place()
arm.set_wait_cmd(tagWAITCmd(100), wait=True, is_queued=True)
arm.set_home_cmd(tagHomeCmd(0), wait=True, is_queued=True)
assert place() == [200.0, 0.0, 50.0], place()
assert arm.get_active_alarms() == set()
arm.set_ptp_cmd(tagPTPCmd(PTPMode.MOVL_XYZ, 20, 40, 50, 5), wait=False, is_queued=True)
assert len(arm.get_active_alarms()) == 1
arm.set_queued_cmd_clear()
arm.clear_all_alarms_state()
assert arm.get_active_alarms() == set()
try:
    arm.get_device_sn()  # its checksum is wrong
except TypeError:
    pass
else:
    raise SystemExit("a packet with a wrong checksum was answered")
arm.conn.serial_conn.close()
"""

CLIENTS = {
    "pydobotlab==0.2.1.1": PYDOBOTLAB,
    "pydobotplus==0.1.2": PYDOBOTPLUS,
    "pydobot==1.3.2": PYDOBOT,
    "dobotwrapperpy==1.3.0": DOBOTWRAPPERPY,
}

THEIR_ARM = """
import json, os, pty, signal, sys, tty
from pydobotlab import simulator
link, path = sys.argv[1:]
class Arm(simulator.FakeDobot):
    # What it has gone to, tick by tick: the trace of its tool.
    def step_toward(self, target):
        reached = super().step_toward(target)
        self.trace.append((self._state.x, self._state.y, self._state.z))
        return reached
Arm.trace = []
arm = Arm(speed_mm_per_s=400.0, tick_hz=500.0)
master, slave = pty.openpty()
tty.setraw(slave)
os.symlink(os.ttyname(slave), link)
def end(*_):
    with open(path, "w") as file:
        json.dump(arm.trace, file)
    os._exit(0)
signal.signal(signal.SIGTERM, end)
data = b""
while True:
    data += os.read(master, 4096)
    while len(data) >= 3 and len(data) >= data[2] + 4:
        frame, data = data[: data[2] + 4], data[data[2] + 4 :]
        os.write(master, arm.handle_frame(frame))
"""
"""pydobotlab's own arm in software on a pseudo terminal: its port, and the file for the trace of its tool.

It models PTP moves; a CP command takes its place in its queue and moves nothing.
"""

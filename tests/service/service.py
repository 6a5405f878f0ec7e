"""The unit for real: systemd as init of a User Mode Linux guest with vcan0, the installed wheel and the shipped unit.

python tests/service/service.py [--folder DIR]    # as root on Debian

Makes a Debian root (debootstrap), installs the wheel of this checkout by docker/install.sh, puts the shipped unit and
tests/service/guest.py into it, and boots it from an ext4 image. Exit code 1 when a claim of the guest does not hold.
Needs debootstrap, user-mode-linux, e2fsprogs; python3 -m pip; a package index.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = "systemd-sysv,udev,kmod,iproute2,can-utils,python3,python3-venv,ca-certificates"
SUITE = "bookworm"
CERTIFICATES = Path("/etc/ssl/certs/ca-certificates.crt")
MODULES = Path("/usr/lib/uml/modules")
BOOT_LIMIT_S = 1800.0
#: Makes vcan0 before the check begins; user-mode-linux has CAN as modules.
INTERFACE = """#!/bin/sh
for name in net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan; do
    for file in /usr/lib/uml/modules/$(uname -r)/kernel/$name.ko*; do [ -e "$file" ] && insmod "$file"; done
done
ip link add vcan0 type vcan && ip link set vcan0 up
"""
CHECK_UNIT = """[Unit]
Description=Check of the hilplant unit
After=multi-user.target
[Service]
Type=oneshot
TimeoutStartSec=infinity
ExecStartPre=/check/interface
ExecStart=/usr/bin/python3 /check/guest.py
ExecStopPost=/bin/systemctl --force --force poweroff
[Install]
WantedBy=graphical.target
"""


def run(*words: object, **more: object) -> None:
    """Run a step; its output is this program's."""
    subprocess.run([str(word) for word in words], check=True, **more)  # type: ignore[call-overload]


def make_root(root: Path) -> None:
    """Make the Debian root with systemd; trust and name server are this machine's."""
    run("debootstrap", "--variant=minbase", f"--include={PACKAGES}", SUITE, root)
    shutil.copy(CERTIFICATES, root / "etc/ssl/certs")
    shutil.copy("/etc/resolv.conf", root / "etc/resolv.conf")


def install(root: Path) -> None:
    """Install the wheel of this checkout as docs/install.md says."""
    wheels = root / "tmp/wheels"
    shutil.rmtree(wheels, ignore_errors=True)
    run(sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--wheel-dir", wheels, ROOT)
    for name in ("install.sh", "requirements.txt"):
        shutil.copy(ROOT / "docker" / name, wheels)
    mounts = 'mount -t proc proc "$0/proc" && mount -t tmpfs tmpfs "$0/dev/shm" && exec chroot "$0" '
    (wheel,) = wheels.glob("hilplant-*.whl")
    step = f"/tmp/wheels/install.sh /tmp/wheels/{wheel.name}"
    trust = {name: str(CERTIFICATES) for name in ("PIP_CERT", "SSL_CERT_FILE")}
    run("unshare", "-m", "sh", "-c", mounts + step, root, env={"PATH": os.environ["PATH"], **trust})


def equip(root: Path) -> None:
    """Put the shipped unit and rule in their places, and the check with its own unit."""
    shutil.copy(ROOT / "docker/hilplant@.service", root / "etc/systemd/system")
    shutil.copy(ROOT / "docker/60-hilplant.rules", root / "etc/udev/rules.d")
    (root / "etc/systemd/system/check.service").write_text(CHECK_UNIT, encoding="utf-8")
    check = root / "check"
    check.mkdir(exist_ok=True)
    shutil.copy(ROOT / "tests/service/guest.py", check)
    (check / "interface").write_text(INTERFACE, encoding="utf-8")
    (check / "interface").chmod(0o755)
    shutil.copytree(MODULES, root / MODULES.relative_to("/"), dirs_exist_ok=True, ignore=_only_can)
    run("systemctl", "-q", f"--root={root}", "enable", "check.service")
    run("systemctl", "-q", f"--root={root}", "set-default", "graphical.target")


def _only_can(folder: str, names: list[str]) -> set[str]:
    """Leave out of a copy every kernel module but those of CAN."""
    return {name for name in names if Path(folder, name).is_file() and "/can" not in folder}


def boot(root: Path, folder: Path) -> list[str]:
    """Boot the root from an image until it powers off; return the lines of the guest's result."""
    image = folder / "root.ext4"
    image.unlink(missing_ok=True)
    run("truncate", "-s", "3G", image)
    run("mkfs.ext4", "-q", "-d", root, image)
    cpu = min(os.sched_getaffinity(0))
    kernel = (
        *("taskset", "-c", str(cpu), "linux.uml", "mem=1G", f"ubd0={image}", "root=/dev/ubda", "rootfstype=ext4", "rw"),
        *(f"uml_dir={folder}", "con0=null,fd:2", "con=null", "quiet", "init=/lib/systemd/systemd"),
    )
    began_s = time.monotonic()
    with (folder / "console").open("wb") as console:
        guest = subprocess.Popen(
            kernel, stdin=subprocess.DEVNULL, stdout=console, stderr=console, start_new_session=True
        )
        try:
            guest.wait(BOOT_LIMIT_S)
        except subprocess.TimeoutExpired:
            sys.stderr.write(f"the guest did not end within {BOOT_LIMIT_S:.0f} s\n")
        finally:
            if guest.poll() is None:
                os.killpg(guest.pid, 9)
    sys.stdout.write(f"guest up for {time.monotonic() - began_s:.0f} s; its console is in {folder / 'console'}\n")
    told = subprocess.run(
        ["debugfs", "-R", "cat /check/result", str(image)], capture_output=True, text=True, check=False
    )
    return told.stdout.splitlines()


def main() -> int:
    """Make, install, boot, report."""
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("--folder", type=Path, help="keeps the root for the next time")
    given = asked.parse_args()
    with tempfile.TemporaryDirectory(prefix="hilplant-service-") as passing:
        folder = (given.folder or Path(passing)).resolve()
        root = folder / "root"
        if not root.exists():
            folder.mkdir(exist_ok=True)
            make_root(root)
        install(root)
        equip(root)
        lines = boot(root, folder)
    sys.stdout.write("\n".join(lines) + "\n")
    return 0 if lines[-1:] == ["end"] and not any(line.startswith("FAILED") for line in lines) else 1


if __name__ == "__main__":
    sys.exit(main())

#!/bin/sh
# Install hilplant for service on Debian or Ubuntu, as root: install.sh WHEEL. The image is built by this script too.
# Its libraries are those of requirements.txt beside it, checked by their hashes; lock.sh makes that file.
# Makes /opt/hilplant (a virtual environment), the user hilplant, and its folders; compiles the models for this processor.
set -eu
wheel=${1:?usage: install.sh WHEEL}
export DEBIAN_FRONTEND=noninteractive

apt-get -q update
apt-get -q install -y --no-install-recommends can-utils iproute2
if ! command -v python3 >/dev/null || ! python3 -c 'import ensurepip' 2>/dev/null; then
    apt-get -q install -y --no-install-recommends python3 python3-venv ca-certificates
fi
rm -rf /var/lib/apt/lists/*

python3 -m venv --clear /opt/hilplant
/opt/hilplant/bin/pip install -q --no-cache-dir --require-hashes --only-binary :all: -r "$(dirname "$0")/requirements.txt"
/opt/hilplant/bin/pip install -q --no-cache-dir --no-deps "$(realpath "$wheel")"

# Compiled models know their sources by the time of change; the layers of an image keep whole seconds of it.
find /opt/hilplant/lib -path '*/site-packages/hilplant/*.py' -exec sh -c 'for f; do touch -d "@$(stat -c %Y "$f")" "$f"; done' - {} +

id hilplant >/dev/null 2>&1 || useradd --system --home-dir /var/lib/hilplant --shell /usr/sbin/nologin hilplant
install -d -o hilplant -g hilplant /var/lib/hilplant /var/cache/hilplant

# Runs the plant for some seconds, in memory: proves the installation and leaves compiled models for the first start. On a
# busy machine it may lose time.
cd /var/lib/hilplant
printf 'extends: virtual.yaml\nloop:\n  lost_time: 1.0\n' >warm-up.yaml
setpriv --reuid=hilplant --regid=hilplant --clear-groups --no-new-privs \
    env HOME=/var/lib/hilplant XDG_CACHE_HOME=/var/cache/hilplant \
    /opt/hilplant/bin/hilplant run warm-up.yaml --seconds 4 --record warm-up.hilrec
rm warm-up.hilrec warm-up.yaml

#!/bin/sh
# First process of the User Mode Linux guest. Makes vcan0, runs FOLDER/command with its three standard streams on the
# serial lines, and leaves its exit code in FOLDER/code, or one line about what is missing in FOLDER/trouble.
folder=$1
streams=/dev/shm/.streams
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin

# Leave the result TEXT in the file NAME; the program that started this guest then ends it and removes the folder.
# If it does not, it was killed, and nobody but the guest can tidy up.
finish() {
    sync
    echo "$2" >"$folder/result"
    mv "$folder/result" "$folder/$1"
    sleep 5
    umount -l "$folder/tmp"
    rm -rf "$folder"
    echo o >/proc/sysrq-trigger
    sleep 60
}

mount -t proc proc /proc
mount -t sysfs sysfs /sys
mkdir -p /dev/shm /dev/pts
mount -t tmpfs tmpfs /dev/shm
mount -t devpts devpts /dev/pts
mount -t tmpfs tmpfs "$folder/tmp"
ln -s /proc/self/fd /dev/fd

# A module that is missing may be built in: whether vcan0 comes up decides.
kernel=/usr/lib/uml/modules/$(uname -r)/kernel
for module in net/can/can net/can/can-raw net/can/can-bcm drivers/net/can/dev/can-dev drivers/net/can/vcan; do
    for file in "$kernel/$module".ko*; do
        [ -e "$file" ] && insmod "$file"
    done
done
ip link set lo up
ip link add vcan0 type vcan && ip link set vcan0 up || finish trouble "no vcan interface; CAN modules expected in $kernel"

if [ -e "$folder/terminal" ]; then
    exec 5<>/dev/ttyS0 || finish trouble "no serial line"
    stty -F /dev/ttyS0 $(cat "$folder/terminal")
    touch "$folder/ready"
    setsid -c -w sh "$folder/command" <&5 >&5 2>&5
    code=$?
    exec 5>&-
    finish code $code
fi

# Held open from here on: a line that is closed is gone.
exec 5>/dev/ttyS0 6>/dev/ttyS1 7</dev/ttyS2 || finish trouble "no serial lines"
stty -F /dev/ttyS0 raw -echo
stty -F /dev/ttyS1 raw -echo
stty -F /dev/ttyS2 -echo
# Pipes between the lines and the command: it shall not take them for a terminal.
mkdir $streams
mkfifo $streams/in $streams/out $streams/err
cat $streams/out >&5 &
out=$!
cat $streams/err >&6 &
err=$!
{
    cat <&7 >$streams/in
    # A second end of the input: the command has ended, or the program that started this guest was killed.
    cat <&7 >/dev/null
    sleep 10
    finish code 2
} &
watcher=$!
touch "$folder/ready"

# The first line that a new session opens becomes its terminal, so that an interrupt character reaches the command.
setsid -w sh -c ': </dev/ttyS2; exec 5>&- 6>&- 7<&-; . "$0"' "$folder/command" \
    <$streams/in >$streams/out 2>$streams/err
code=$?
kill $watcher

# A program left behind may hold the pipes open; do not wait for it.
(sleep 2 && kill $out $err) &
wait $out $err
exec 5>&- 6>&-
finish code $code

"""Command lines that are wrong, or have no effect beyond the folder of their test, as a user may type them."""

# One command line each; what has an effect beyond this folder is not among them.
LINES = """
lanch
xyzzy
topic list
node list
service list
param set a b
bag record
rosrun demo talker
roscore
rviz
status
update
install demo
rename bob
world
world=office
commit
drive
goto 2 3
ssh bob
explore
maps join a b
maps ls
maps rm a
launch ubiquity_launches m_robot_base.launch.xml x:=abc
launch ubiquity_launches m_robot_base.launch.xml office
launch ubiquity_launches m_robot_base.launch.xml world=office
launch ubiquity_launches m_robot_base.launch.xml --world office
launch ubiquity_launches m_make_map.launch.xml explore:=yes map:=x
launch ubiquity_launches m_robot_base.launch.xml robot_base:=turtlebot4
use sim:turtlebot4
keyboard_driv
empty.launch
--versoin
help lst
run keyboard_navigat
run ../ur
run src/demo/launch/talker.launch
launch ubiquity_launches m_robot_base.launch.xml simulate:=flase
launch ubiquity_launches m_robot_base.launch.xml bring_up:=on
launch nothing.launch
launch empty
launch demo
launch demo talkr.launch
launch demo twice.launch
launch dmeo talker.launch
launch src/demo/launch/talkr.launch
launch empty.launch
launch text.launch
launch notes.txt
launch ros2.launch
launch ros2.launch.py
launch missing.launch
launch package.launch
launch machine.launch
launch demo speed.launch
launch demo speed.launch sped:=1
launch demo speed.launch speed
launch demo speed.launch 1:=2
launch --nodes nothing.launch
launch --nodes text.launch
launch --find-node talkr demo talker.launch
launch --args talkr demo talker.launch
launch --ros-args nothing.launch
launch --files nothing.launch
launch --dump-params nothing.launch
launch --wait --port 0 demo talker.launch
launch ubiquity_launches m_robot_base.launch.xml robot_base:=mangi
ps --ended more
attach nobody
replay
replay absent.mcap
replay notes.txt --info
record x:=1
replay notes.txt nobody
replay notes.txt keyboard_navigate fast
logs
logs talker
logs talker --run nothing
report nothing
restart talker
restart talker --run nothing
wait
wait nothing
stop
stop nothing
stop --node talker
stop nothing --all
check nothing.launch
check notes.txt
check empty
check empty.launch
check text.launch
check ros2.launch
check ros2.launch.py
check node.launch
check --select bad-xlm
check --ignore valeus
check --explain bad-xlm
check --no-cache nothing.launch
check src/demo/launch/speed.launch sped:=1
check list.yaml picture.png
check --package nothing
check --package notes.txt
check --package empty
check --package one two
format nothing.launch
format notes.txt
format text.launch
format ros2.launch
find talker nothing
find nobody src/demo
docs nothing
docs empty
docs notes.txt --output -
graph nothing.launch
graph demo talkr.launch
graph text.launch
graph demo talker.launch --as png
graph --live
graph demo talker.launch --output picture.gif
explain talker
explain nothing.launch speed
explain demo speed.launch spede
explain demo speed.launch speed
use mangi
use sim:mangi
use sim:magni:lidra
use a:b:c:d
use 'a b'
use robot.example.org
web nosuchrobot
web sim:mangi
web --days never
web --foxglove-origin viewer.example
mcp grant --programs
record --split 100 --keep-free 500 'a b'
launch --respawn-limit 3 --screen --log talker.launch
lsp --stdio more
setup debian install
setup debian status more
setup debian remvoe
setup --undo --dry-run more
robots 'a b'
shell
shell --nonsense
shell 'a b'
shell -- -oProxyCommand=x
shell --check carrot
shell -X carrot
shell -X 'a b' word
sync 'a b'
sync --all
sync --to --from carrot
sync
mount
mount 'a b'
mount nobody --undo
mount --undo 'a b'
doctor 'a b'
doctor bob,'e e'
doctor --wireless 'a b'
doctor --wireless --fix carrot
doctor --watch carrot
get
get 'a b'
get speed:=1
get --missing nowhere/at/all
devices bob
devices --robot 'a b'
devices --rules --base mangi
devices --rules --base magni --variant ldar
robot setup
robot setup 'a b'
robot setup --all
robot setup --all bob
robot setup --from nothing.yaml
robot setup --from robots.yaml
robot setup --from list.yaml
robot setup --base mangi carrot
robot setup --name 'a b' carrot
robot setup --name a carrot parsnip
robot setup --variant lidra --base magni carrot
robot rename carrot 'a b'
robot rename 'a b' carrot
robot rename carrot carrot
robot calibrate 'a b'
robot wifi 'a b'
robot wifi --ssid home --forget home carrot
robot wifi --band 5 carrot
robot wifi --hidden carrot
robot setup --no-master --from nothing.yaml
robot network 'a b'
robot network --address 300.1.1.1/24 carrot
robot network --address 192.168.1.7 carrot
robot network --address 192.168.1.7/24 --dhcp carrot
robot network --gateway 192.168.1.1 carrot
robot network --dns one carrot
image prepare nothing.img
image prepare notes.txt
image prepare --name 'a b' notes.txt
image prepare --name carrot notes.txt
image prepare --name carrot --base mangi notes.txt
image prepare --from nothing.yaml notes.txt
image prepare --from robots.yaml notes.txt
image prepare --country Germany --name carrot notes.txt
image prepare --undo notes.txt
image prepare empty
boot install
boot install --nonsense
boot install nothing
boot install demo talkr.launch
boot install demo speed.launch
boot install demo speed.launch sped:=1
boot install --name 'a b' demo talker.launch
boot remove nothing
boot status --all
boot remove
maps show nothing
maps import nothing.yaml
maps copy flat
maps rename nothing a/b
maps edit nothing rotate
maps export nothing out
new node 1st --from-package demo --type talker --no-look
new node talker --package src/demo --from-package dmeo --type talker --no-look
new node talker --package src/demo --from-package demo --type tlker --no-look
new node talker --package src/demo --no-look
new multi all --package src/demo
new multi all --package src/demo --include nothing
new multi 1st --include talker
new base mangi --package src/demo --like nothing
new base 1st
new base small --package src/demo --mass -1
new base small --package src/demo --width 0 --length 0.3
new base small --package src/demo --from nothing.urdf
new base small --package src/demo --from picture.png
new base small --package src/demo --from src/demo/package.xml
new base small --package src/demo --from src/demo/package.xml --lidar
new base small --package src/demo --workspace own
new base small --package src/demo --driver mangi
new package 1st
new package Demo
new package demo
new node talker --package src/demo --summary Talk. --from-package dmeo --type talker --no-look
new node talker --package src/demo --summary Talk. --from-package demo --type tlker --no-look
new multi all --package src/demo --summary Talk. --include nothing
new base small --package src/demo --summary Talk. --mass -1
new package nose --summary Talk. --email nobody
new script Look
new world a/b --size 8x6
new world office
new world office --size big
new world office --size 0x6
new world office --size 8x6 --picture picture.png
new world office --picture nothing.png
new world office --picture picture.png --width 10
new world office --size 8x6 --cell 0
""".strip().splitlines()

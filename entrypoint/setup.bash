# EdgeVox's environment, to be sourced by bash: ROS 2's, before it our interfaces (ros/ in the prefix
# that this file is in), and the programs.
_edgevox=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=/dev/null
source /opt/ros/jazzy/setup.bash --
export PATH="$_edgevox/bin:$PATH"
export AMENT_PREFIX_PATH="$_edgevox:$_edgevox/ros:$AMENT_PREFIX_PATH"
export LD_LIBRARY_PATH="$_edgevox/ros/lib:$LD_LIBRARY_PATH"
export PYTHONPATH="$(echo "$_edgevox"/ros/lib/python3.*/site-packages):$PYTHONPATH"
unset _edgevox
# The interfaces of the robot's folder, as `edgevox interfaces --to` or colcon built them.
for _setup in "${EDGEVOX_ROBOT_FOLDER:-}"/interfaces/{local_,}setup.bash; do
    if [[ -f $_setup ]]; then
        # shellcheck source=/dev/null
        source "$_setup"
        break
    fi
done
unset _setup

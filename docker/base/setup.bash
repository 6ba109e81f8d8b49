# ROS 2 Jazzy out of wheels, sourced as a ROS 2 installation is: any python3 then imports rclpy.
_ros_prefix=/opt/ros/jazzy
_ros_packages=$(echo "$_ros_prefix"/lib/python3.*/site-packages)
_ros_prepend() { # variable, folder
    case ":${!1}:" in
        *":$2:"*) ;;
        *) export "$1=$2${!1:+:${!1}}" ;;
    esac
}

export ROS_DISTRO=jazzy ROS_VERSION=2 ROS_PYTHON_VERSION=3
# Each wheel's libraries are found by the linker here, not by the wheels' re-start of python.
export _ROS_WHEELS_BOOTSTRAP_COMPLETE=1
for _ros_folder in "$_ros_packages"/ros_*.libs "$_ros_prefix/lib"; do
    _ros_prepend LD_LIBRARY_PATH "$_ros_folder"
done
_ros_prepend PYTHONPATH "$_ros_packages"
_ros_prepend AMENT_PREFIX_PATH "$_ros_prefix"
_ros_prepend PATH "$_ros_prefix/bin"
unset _ros_prefix _ros_packages _ros_folder
unset -f _ros_prepend

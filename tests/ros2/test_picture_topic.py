"""The picture that was asked for, as a node hears it that comes later."""

from interop_rig import Messages
from peer import STATE
from sensor_msgs.msg import CompressedImage

from edgevox.core.bus import Bus
from edgevox.core.events import PictureTaken
from edgevox.ros2.bridge import PicturePublisher
from edgevox.ros2.node import RosNode

TOPIC = "/edgevox/picture"


def test_who_comes_later_gets_the_last_picture(domain, monkeypatch, peer):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    bus, ros = Bus(), RosNode("/edgevox", ())
    pictures = PicturePublisher(ros.node, bus, "camera_optical_frame")
    ros.start()
    try:
        bus.publish(PictureTaken(b"first", "1.png"))
        bus.publish(PictureTaken(b"last", "2.png"))
        messages = Messages()
        peer().node.create_subscription(CompressedImage, TOPIC, messages.add, STATE)
        messages.wait_for(lambda _: bool(messages.messages))
    finally:
        pictures.close()
        ros.close()
    (told,) = messages.messages
    assert bytes(told.data) == b"last"
    assert "png" in told.format
    assert told.header.frame_id == "camera_optical_frame"
    assert told.header.stamp.sec > 0

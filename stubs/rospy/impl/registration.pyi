from rospy.topics import _TopicManager

class RegManager:
    master_uri: str
    uri: str
    def publisher_update(self, resolved_name: str, uris: list[str]) -> None: ...

def get_topic_manager() -> _TopicManager: ...

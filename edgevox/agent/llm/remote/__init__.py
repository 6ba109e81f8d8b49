"""A language model on a server of the network that speaks the OpenAI protocol.

`EndpointModel` asks the server; `FallbackModel` lets the embedded model answer while that cannot.
"""

from edgevox.agent.llm.remote.fallback import FallbackModel
from edgevox.agent.llm.remote.remote_model import EndpointModel
from edgevox.core.servers.address import Address

__all__ = ["Address", "EndpointModel", "FallbackModel"]

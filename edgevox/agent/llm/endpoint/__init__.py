"""A language model on a server of the network that speaks the OpenAI protocol.

`EndpointModel` asks the server; `FallbackModel` lets the embedded model answer while that cannot.
"""

from edgevox.agent.llm.endpoint.address import Address
from edgevox.agent.llm.endpoint.endpoint_model import EndpointModel
from edgevox.agent.llm.endpoint.fallback import FallbackModel

__all__ = ["Address", "EndpointModel", "FallbackModel"]

# All images in one definition: `docker buildx bake -f docker/bake.hcl`, in the repository's root.
#
# PLATFORMS="linux/amd64,linux/arm64" with `--set '*.output=type=registry'` builds for both; that needs
# a builder for both, and the official base, which alone has ROS 2 for arm64. Where no registry is
# reached, docker/base/build makes a base and ROS_IMAGE=edgevox-base:local names it (amd64 only).

variable "ROS_IMAGE" { default = "ros:jazzy-ros-base" }
variable "MODEL_SET" { default = "small robots" }
variable "EDGEVOX_UID" { default = "1000" }
variable "EDGEVOX_GID" { default = "1000" }
variable "PLATFORMS" { default = "linux/amd64" }
variable "REPOSITORY" { default = "edgevox-ros2" }
variable "TAG" { default = "local" }
variable "VERSION" { default = "" }
variable "REVISION" { default = "" }
variable "CREATED" { default = "" }
variable "SOURCE" { default = "" }
variable "BASE_DIGEST" { default = "" }
# The certificates of a TLS proxy, if there is one.
variable "CA_BUNDLE" { default = "/dev/null" }
# A folder of models that are on this machine already; each is verified, the rest is fetched.
variable "MODELS" { default = "" }

group "default" { targets = ["edgevox"] }
group "all" { targets = ["edgevox", "slim"] }

target "common" {
  context    = "."
  dockerfile = "Dockerfile.ros2"
  platforms  = split(",", PLATFORMS)
  secret     = ["id=ca_bundle,src=${CA_BUNDLE}"]
  args = {
    ROS_IMAGE   = ROS_IMAGE
    EDGEVOX_UID = EDGEVOX_UID
    EDGEVOX_GID = EDGEVOX_GID
    VERSION     = VERSION
  }
  labels = {
    "org.opencontainers.image.version"     = VERSION
    "org.opencontainers.image.revision"    = REVISION
    "org.opencontainers.image.created"     = CREATED
    "org.opencontainers.image.source"      = SOURCE
    "org.opencontainers.image.base.digest" = BASE_DIGEST
  }
}

target "edgevox" {
  inherits = ["common"]
  target   = "edgevox"
  args     = { MODEL_SET = MODEL_SET }
  contexts = MODELS == "" ? {} : { models = MODELS }
  tags     = ["${REPOSITORY}:${TAG}"]
}

# For real robots: neither models nor simulators.
target "slim" {
  inherits = ["common"]
  target   = "slim"
  tags     = ["${REPOSITORY}:${TAG}-slim"]
}

# pip with the image's Python, for a stage of an image derived from it (docs/deployment.md).
target "tools" {
  inherits = ["common"]
  target   = "tools"
  tags     = ["${REPOSITORY}:${TAG}-tools"]
}

# It builds a robot's own packages of interfaces (docs/deployment.md).
target "interfaces" {
  inherits = ["common"]
  target   = "interfaces"
  tags     = ["${REPOSITORY}:${TAG}-interfaces"]
}

{{/* The variables of one robot, as docs/deployment.md lists them. Takes root and robot. */}}
{{- define "edgevox.environment" -}}
{{- $robot := .robot -}}
{{- $env := dict
  "ROS_DOMAIN_ID" ($robot.domain | int)
  "EDGEVOX_AGENT_NAMESPACE" $robot.agentNamespace
  "EDGEVOX_AGENT" $robot.agent
  "EDGEVOX_LANGUAGE" $robot.language
  "EDGEVOX_VOICE" $robot.voice
  "EDGEVOX_MUTED" $robot.muted
  "EDGEVOX_WAKEWORD" $robot.wakeword
  "EDGEVOX_AUDIO_IN" $robot.audioIn
  "EDGEVOX_AUDIO_OUT" $robot.audioOut
  "EDGEVOX_LOG_LEVEL" $robot.logLevel
  "EDGEVOX_DRAIN_S" $robot.drainSeconds
  "EDGEVOX_IMAGE" (include "edgevox.image" .root)
  "EDGEVOX_ROBOT_NAMESPACE" $robot.robotNamespace
  "EDGEVOX_FRAME_PREFIX" $robot.framePrefix
  "EDGEVOX_OFFLINE" $robot.models.offline
  "EDGEVOX_LLM" $robot.llm.model
  "EDGEVOX_LLM_THREADS" ($robot.llm.threads | int)
  "EDGEVOX_LLM_CONTEXT" ($robot.llm.context | int)
  "EDGEVOX_HEALTH_PORT" ($robot.health.port | int)
  "EDGEVOX_HEALTH_HOST" (ternary "127.0.0.1" $robot.health.host $robot.hostNetwork)
  "ROS_AUTOMATIC_DISCOVERY_RANGE" $robot.discovery.range
  "ROS_DISCOVERY_SERVER" (include "edgevox.discoveryServers" .)
  "EDGEVOX_PEERS_WAIT_S" ($robot.discovery.peersWaitSeconds | int)
  "ROS_STATIC_PEERS" (include "edgevox.peers" .)
-}}
{{- /* Off, rather than as the image has it, where nobody reads them. */ -}}
{{- $metrics := and .root.Values.serviceMonitor.enabled (not $robot.hostNetwork) -}}
{{- $_ := set $env "EDGEVOX_METRICS_PORT" (ternary (int .root.Values.serviceMonitor.port) 0 $metrics) -}}
{{- if $metrics -}}
{{- $_ := set $env "EDGEVOX_METRICS_HOST" $robot.health.host -}}
{{- end -}}
{{- if $robot.hostNetwork -}}
{{- $_ := set $env "FASTDDS_BUILTIN_TRANSPORTS" "UDPv4" -}}
{{- end -}}
{{- if $robot.security.enabled -}}
{{- $_ := set $env "EDGEVOX_SECURITY_KEYSTORE" "/etc/edgevox/security" -}}
{{- $_ := set $env "EDGEVOX_SECURITY_ENCLAVE" $robot.security.enclave -}}
{{- end -}}
{{- if $robot.console.enabled -}}
{{- $_ := set $env "EDGEVOX_CONSOLE" true -}}
{{- $_ := set $env "EDGEVOX_CONSOLE_PORT" (int $robot.console.port) -}}
{{- $_ := set $env "EDGEVOX_CONSOLE_HOST" (ternary "127.0.0.1" $robot.health.host $robot.hostNetwork) -}}
{{- $_ := set $env "EDGEVOX_CONSOLE_FOLDER" "/console" -}}
{{- $_ := set $env "EDGEVOX_CONSOLE_NAMES" (include "edgevox.consoleNames" .) -}}
{{- $_ := set $env "EDGEVOX_CONSOLE_RECORDINGS" "/recordings" -}}
{{- $_ := set $env "EDGEVOX_CONSOLE_RECORDINGS_MB" (int $robot.console.recordings.mb) -}}
{{- if $robot.console.tlsSecret -}}
{{- $_ := set $env "EDGEVOX_CONSOLE_TLS" "files" -}}
{{- $_ := set $env "EDGEVOX_CONSOLE_CERTIFICATE" "/run/secrets/edgevox-console/tls.crt" -}}
{{- $_ := set $env "EDGEVOX_CONSOLE_KEY" "/run/secrets/edgevox-console/tls.key" -}}
{{- end -}}
{{- end -}}
{{- if $robot.policy -}}
{{- $_ := set $env "EDGEVOX_POLICY" "/etc/edgevox/policy/policy.yaml" -}}
{{- end -}}
{{- if or $robot.files.data $robot.files.configMap -}}
{{- $_ := set $env "EDGEVOX_ROBOT_FOLDER" "/etc/edgevox/robot" -}}
{{- end -}}
{{- if $robot.plugins.volume -}}
{{- $_ := set $env "EDGEVOX_PLUGINS" "/plugins" -}}
{{- $_ := set $env "EDGEVOX_AGENT" ($robot.plugins.agent | default $robot.agent) -}}
{{- end -}}
{{- with $robot.llm.endpoint -}}
{{- $_ := set $env "EDGEVOX_LLM_ENDPOINT" . -}}
{{- $_ := set $env "EDGEVOX_LLM_ENDPOINT_MODEL" $robot.llm.endpointModel -}}
{{- $_ := set $env "EDGEVOX_LLM_ENDPOINT_TIMEOUT" $robot.llm.endpointTimeoutSeconds -}}
{{- $_ := set $env "EDGEVOX_LLM_ENDPOINT_GRAMMAR" $robot.llm.endpointGrammar -}}
{{- if $robot.llm.endpointKeySecret.name -}}
{{- $_ := set $env "EDGEVOX_LLM_ENDPOINT_KEY_FILE" "/run/secrets/edgevox-llm/key" -}}
{{- end -}}
{{- end -}}
{{- range $part := list "stt" "tts" -}}
{{- $server := get $robot $part -}}
{{- with $server.endpoint -}}
{{- $name := printf "EDGEVOX_%s_ENDPOINT" (upper $part) -}}
{{- $_ := set $env $name . -}}
{{- $_ := set $env (printf "%s_MODEL" $name) $server.endpointModel -}}
{{- $_ := set $env (printf "%s_TIMEOUT" $name) $server.endpointTimeoutSeconds -}}
{{- if eq $part "tts" -}}
{{- $_ := set $env (printf "%s_VOICE" $name) $server.endpointVoice -}}
{{- end -}}
{{- if $server.endpointKeySecret.name -}}
{{- $_ := set $env (printf "%s_KEY_FILE" $name) (printf "/run/secrets/edgevox-%s/key" $part) -}}
{{- end -}}
{{- end -}}
{{- end -}}
{{- range $name, $value := mergeOverwrite $env $robot.settings -}}
{{- if and (kindIs "float64" $value) (eq (floor $value) (float64 $value)) -}}
{{- $value = int64 $value -}}
{{- end -}}
{{- if ne (toString $value) "" }}
- name: {{ $name }}
  value: {{ toString $value | quote }}
{{- end -}}
{{- end -}}
{{- with $robot.env }}
{{ toYaml . }}
{{- end -}}
{{- end -}}

{{/* Whom a robot looks for where there is no multicast: those on its domain, and who was named. */}}
{{- define "edgevox.peers" -}}
{{- $root := .root -}}
{{- $robot := .robot -}}
{{- $peers := $robot.discovery.staticPeers -}}
{{- if $robot.discovery.amongRobots -}}
{{- range .robots -}}
{{- if and (eq (int .domain) (int $robot.domain)) (ne .name $robot.name) (not .hostNetwork) -}}
{{- $peers = append $peers (include "edgevox.host" (dict "root" $root "robot" .)) -}}
{{- end -}}
{{- end -}}
{{- end -}}
{{- join ";" $peers -}}
{{- end -}}

{{/* Name of the release's objects: short enough for a robot's name after it. */}}
{{- define "edgevox.fullname" -}}
{{- $name := .Release.Name -}}
{{- if not (contains .Chart.Name $name) -}}
{{- $name = printf "%s-%s" $name .Chart.Name -}}
{{- end -}}
{{- $name | trunc 26 | trimSuffix "-" -}}
{{- end -}}

{{- define "edgevox.selector" -}}
app.kubernetes.io/name: {{ .Chart.Name }}
app.kubernetes.io/instance: {{ .Release.Name }}
{{- end -}}

{{- define "edgevox.labels" -}}
{{ include "edgevox.selector" . }}
app.kubernetes.io/version: {{ .Chart.AppVersion | quote }}
app.kubernetes.io/managed-by: {{ .Release.Service }}
helm.sh/chart: {{ printf "%s-%s" .Chart.Name .Chart.Version | replace "+" "_" }}
{{- end -}}

{{/* What tells one robot from the others; the domain is what a NetworkPolicy goes by. */}}
{{- define "edgevox.robotLabels" -}}
edgevox/robot: {{ .name }}
edgevox/domain: {{ .domain | int | quote }}
{{- end -}}

{{- define "edgevox.image" -}}
{{- if .Values.image.digest -}}
{{ .Values.image.repository }}@{{ .Values.image.digest }}
{{- else -}}
{{ .Values.image.repository }}:{{ .Values.image.tag | default .Chart.AppVersion }}
{{- end -}}
{{- end -}}

{{/* What values were called before. */}}
{{- define "edgevox.oldNames" -}}
{"namespace": "agentNamespace", "externalNamespace": "robotNamespace"}
{{- end -}}

{{/* Values by the names of now, as JSON, also those that came by an old one. Takes values and where they stand. */}}
{{- define "edgevox.renamed" -}}
{{- $values := deepCopy .values -}}
{{- $where := .where -}}
{{- range $old, $new := include "edgevox.oldNames" . | fromJson -}}
{{- if hasKey $values $old -}}
{{- $value := get $values $old -}}
{{- $other := get $values $new | default $value -}}
{{- if ne $value $other -}}
{{- fail (printf "%s%s: got %q, expected %q, as %s says, or only one" $where $old $value $other $new) -}}
{{- end -}}
{{- $_ := set $values $new $value -}}
{{- $_ := unset $values $old -}}
{{- end -}}
{{- end -}}
{{- toJson $values -}}
{{- end -}}

{{/* All robots, each with what counts for all of them filled in: a list under "robots", as JSON. */}}
{{- define "edgevox.robots" -}}
{{- $common := pick .Values "affinity" "agent" "audioIn" "audioOut" "console" "discovery" "drainSeconds" "env" "externalNamespace" "extraVolumeMounts" "extraVolumes" "files" "framePrefix" "health" "hostNetwork" "language" "llm" "logLevel" "models" "muted" "nodeSelector" "places" "plugins" "podAnnotations" "podLabels" "policy" "priorityClassName" "recorder" "resources" "robotNamespace" "runtimeClassName" "security" "settings" "stt" "tolerations" "topologySpreadConstraints" "tts" "voice" "wakeword" -}}
{{- /* The default of the new name says nothing against a value by the old one. */ -}}
{{- if and (hasKey $common "externalNamespace") (eq $common.robotNamespace "/") -}}
{{- $_ := unset $common "robotNamespace" -}}
{{- end -}}
{{- $common = include "edgevox.renamed" (dict "values" $common "where" "") | fromJson -}}
{{- $robots := list -}}
{{- range $index, $given := .Values.robots -}}
{{- $where := printf "robots[%d]." $index -}}
{{- $own := include "edgevox.renamed" (dict "values" $given "where" $where) | fromJson -}}
{{- $namespace := printf "/%s" (replace "-" "_" .name) -}}
{{- $robot := mergeOverwrite (deepCopy $common) (dict "agentNamespace" $namespace) $own -}}
{{- /* A volume has one source: a robot's own takes the place of the common one. */ -}}
{{- if hasKey (.models | default dict) "volume" -}}
{{- $_ := set $robot.models "volume" .models.volume -}}
{{- end -}}
{{- /* A policy is one text: a robot's own takes the place of the common one. */ -}}
{{- if hasKey . "policy" -}}
{{- $_ := set $robot "policy" .policy -}}
{{- end -}}
{{- if hasKey (.console | default dict) "volume" -}}
{{- $_ := set $robot.console "volume" .console.volume -}}
{{- end -}}
{{- if hasKey ((.console | default dict).recordings | default dict) "volume" -}}
{{- $_ := set $robot.console.recordings "volume" .console.recordings.volume -}}
{{- end -}}
{{- if hasKey (.places | default dict) "volume" -}}
{{- $_ := set $robot.places "volume" .places.volume -}}
{{- end -}}
{{- if hasKey (.plugins | default dict) "volume" -}}
{{- $_ := set $robot.plugins "volume" .plugins.volume -}}
{{- end -}}
{{- if hasKey (.recorder | default dict) "volume" -}}
{{- $_ := set $robot.recorder "volume" .recorder.volume -}}
{{- end -}}
{{- /* Files are one robot's: its own take the place of the common ones. */ -}}
{{- if hasKey . "files" -}}
{{- $_ := set $robot "files" (mergeOverwrite (dict "data" (dict) "configMap" "") .files) -}}
{{- end -}}
{{- $robots = append $robots $robot -}}
{{- end -}}
{{- $metricsPort := ternary (int .Values.serviceMonitor.port) 0 .Values.serviceMonitor.enabled -}}
{{- include "edgevox.validate" (dict "robots" $robots "metricsPort" $metricsPort) -}}
{{- dict "robots" $robots | toJson -}}
{{- end -}}

{{/* Who a robot is to DDS security. */}}
{{- define "edgevox.enclave" -}}
{{- .security.enclave | default (printf "%s/edgevox" (trimSuffix "/" .agentNamespace)) -}}
{{- end -}}

{{/* Who its recorder is. */}}
{{- define "edgevox.recorderEnclave" -}}
{{- printf "%s/edgevox_recorder" (trimSuffix "/" .agentNamespace) -}}
{{- end -}}

{{/* The Secret of an enclave, as edgevox-security names it. Takes name and enclave. */}}
{{- define "edgevox.secret" -}}
{{- .name | default (printf "edgevox-security%s" (.enclave | replace "/" "-" | replace "_" "-" | lower)) -}}
{{- end -}}

{{/* The volume with an enclave's files. Takes volume, name and enclave. */}}
{{- define "edgevox.securityVolume" -}}
- name: {{ .volume }}
  secret:
    secretName: {{ include "edgevox.secret" . }}
    # The group is the pod's fsGroup; nobody else reads the key.
    defaultMode: 0440
{{- end -}}

{{/* The host name of a robot's pod, which stays the same when it is made anew. */}}
{{- define "edgevox.host" -}}
{{- $name := include "edgevox.fullname" .root -}}
{{ $name }}-{{ .robot.name }}-0.{{ $name }}.{{ .root.Release.Namespace }}.svc
{{- end -}}

{{/* What tells the discovery servers of a domain from all else. Takes root and domain. */}}
{{- define "edgevox.discoverySelector" -}}
app.kubernetes.io/name: {{ .root.Chart.Name }}-discovery
app.kubernetes.io/instance: {{ .root.Release.Name }}
edgevox/domain: {{ .domain | quote }}
{{- end -}}

{{- define "edgevox.discoveryLabels" -}}
{{ include "edgevox.discoverySelector" . }}
app.kubernetes.io/version: {{ .root.Chart.AppVersion | quote }}
app.kubernetes.io/managed-by: {{ .root.Release.Service }}
helm.sh/chart: {{ printf "%s-%s" .root.Chart.Name .root.Chart.Version | replace "+" "_" }}
{{- end -}}

{{/* The value of ROS_DISCOVERY_SERVER. Takes root and robot. */}}
{{- define "edgevox.discoveryServers" -}}
{{- if .robot.discovery.servers -}}
{{- $name := printf "%s-discovery%d" (include "edgevox.fullname" .root) (int .robot.domain) -}}
{{- $namespace := .root.Release.Namespace -}}
{{- $places := list -}}
{{- range $number := until 2 }}{{ $places = append $places (printf "%s-%d.%s.svc:11811" $name $number $namespace) }}{{ end -}}
{{- join ";" $places -}}
{{- else -}}
{{- .robot.discovery.server -}}
{{- end -}}
{{- end -}}

{{/* The Service of a robot's console. Takes root and robot. */}}
{{- define "edgevox.consoleService" -}}
{{ include "edgevox.fullname" .root }}-{{ .robot.name }}-console
{{- end -}}

{{/* By which names a robot's console is opened, with commas between. Takes root and robot. */}}
{{- define "edgevox.consoleNames" -}}
{{- $names := .robot.console.names -}}
{{- if not .robot.hostNetwork -}}
{{- $service := include "edgevox.consoleService" . -}}
{{- $names = append $names (printf "%s.%s.svc" $service .root.Release.Namespace) -}}
{{- with .robot.console.ingress -}}
{{- if .enabled -}}
{{- $names = append $names .host -}}
{{- end -}}
{{- end -}}
{{- end -}}
{{- join "," (uniq $names) -}}
{{- end -}}

{{/* That no two servers of a pod want one port. Takes where, robot and metricsPort: 0 without metrics. */}}
{{- define "edgevox.validatePorts" -}}
{{- $where := .where -}}
{{- $taken := dict -}}
{{- $ports := list (list "health.port" (int .robot.health.port)) -}}
{{- if and .metricsPort (not .robot.hostNetwork) -}}
{{- $ports = append $ports (list "serviceMonitor.port" .metricsPort) -}}
{{- end -}}
{{- if .robot.console.enabled -}}
{{- $ports = append $ports (list "console.port" (int .robot.console.port)) -}}
{{- end -}}
{{- if .robot.recorder.enabled -}}
{{- $ports = append $ports (list "recorder.healthPort" (int .robot.recorder.healthPort)) -}}
{{- if and .metricsPort (not .robot.hostNetwork) -}}
{{- $ports = append $ports (list "recorder.metricsPort" (int .robot.recorder.metricsPort)) -}}
{{- end -}}
{{- end -}}
{{- range $ports -}}
{{- $value := first . -}}
{{- $port := last . | toString -}}
{{- if hasKey $taken $port -}}
{{- fail (printf "%s.%s: got %s, expected another port than %s has" $where $value $port (get $taken $port)) -}}
{{- end -}}
{{- $_ := set $taken $port $value -}}
{{- end -}}
{{- end -}}

{{/* What one schema cannot say: that robots do not get into each other's way. */}}
{{- define "edgevox.validate" -}}
{{- $metricsPort := .metricsPort -}}
{{- $names := dict -}}
{{- $nodes := dict -}}
{{- $frames := dict -}}
{{- $hosts := dict -}}
{{- $secrets := dict -}}
{{- range $index, $robot := .robots -}}
{{- $where := printf "robots[%d]" $index -}}
{{- if hasKey $names .name -}}
{{- fail (printf "%s.name: got %q, expected a name that no other robot has" $where .name) -}}
{{- end -}}
{{- $_ := set $names .name true -}}
{{- if and .discovery.servers (regexMatch "^discovery[0-9]+$" .name) -}}
{{- fail (printf "%s.name: got %q, expected another name, since discovery servers have these" $where .name) -}}
{{- end -}}
{{- include "edgevox.validatePorts" (dict "where" $where "robot" . "metricsPort" $metricsPort) -}}
{{- if and .files.data .files.configMap -}}
{{- fail (printf "%s.files.configMap: got %q, expected none beside files.data" $where .files.configMap) -}}
{{- end -}}
{{- if .security.enabled -}}
{{- $enclave := include "edgevox.enclave" . -}}
{{- if hasKey $secrets $enclave -}}
{{- fail (printf "%s.security.enclave: got %q, expected another one than %s has" $where $enclave (get $secrets $enclave)) -}}
{{- end -}}
{{- $_ := set $secrets $enclave .name -}}
{{- $secret := include "edgevox.secret" (dict "name" .security.secretName "enclave" $enclave) -}}
{{- if hasKey $secrets $secret -}}
{{- fail (printf "%s.security.secretName: got %q, expected another one than %s has" $where $secret (get $secrets $secret)) -}}
{{- end -}}
{{- $_ := set $secrets $secret .name -}}
{{- if .discovery.server -}}
{{- fail (printf "%s.discovery.server: got %q, expected none with security, since a server has no enclave" $where .discovery.server) -}}
{{- end -}}
{{- if .discovery.servers -}}
{{- fail (printf "%s.discovery.servers: got true, expected false with security, since a server has no enclave" $where) -}}
{{- end -}}
{{- end -}}
{{- if and .discovery.server .discovery.servers -}}
{{- fail (printf "%s.discovery.server: got %q, expected none beside discovery.servers" $where .discovery.server) -}}
{{- end -}}
{{- if and .console.enabled .console.ingress.enabled -}}
{{- $host := .console.ingress.host -}}
{{- if not $host -}}
{{- fail (printf "%s.console.ingress.host: got %q, expected a host name" $where $host) -}}
{{- end -}}
{{- if hasKey $hosts $host -}}
{{- fail (printf "%s.console.ingress.host: got %q, expected another one than %s has" $where $host (get $hosts $host)) -}}
{{- end -}}
{{- if .hostNetwork -}}
{{- fail (printf "%s.console.ingress.enabled: got true, expected false on the host's network, where the console is on loopback" $where) -}}
{{- end -}}
{{- $_ := set $hosts $host .name -}}
{{- end -}}
{{- /* A server knows no domains: who asks the same one hears each other. */ -}}
{{- $heard := .discovery.server | default (printf "domain %d" (int .domain)) -}}
{{- $node := printf "%s %s" $heard (trimPrefix "/" .agentNamespace) -}}
{{- if hasKey $nodes $node -}}
{{- fail (printf "%s.agentNamespace: got %q, expected another one than %s has, which is on %s too" $where .agentNamespace (get $nodes $node) $heard) -}}
{{- end -}}
{{- $_ := set $nodes $node .name -}}
{{- $frame := printf "%s %s" $heard .framePrefix -}}
{{- if hasKey $frames $frame -}}
{{- fail (printf "%s.framePrefix: got %q, expected another one than %s has, since they share %s and /tf" $where .framePrefix (get $frames $frame) $heard) -}}
{{- end -}}
{{- $_ := set $frames $frame .name -}}
{{- end -}}
{{- end -}}

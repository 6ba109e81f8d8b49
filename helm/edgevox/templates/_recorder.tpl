{{/* The recorder beside a robot, with its rights and its network. Takes root, robot and robots. */}}
{{- define "edgevox.recorder" -}}
{{- /* What it hears by is the robot's; what the robot is made of is not for it. */ -}}
{{- $own := dict "files" (dict "data" (dict) "configMap" "") "plugins" (dict "volume" (dict)) "policy" (dict) "env" (list) "console" (dict "enabled" false) -}}
{{- $none := dict "endpoint" "" "model" "none" -}}
{{- $robot := mergeOverwrite (deepCopy .robot) (dict "llm" $none "settings" (dict)) -}}
{{- range $name, $value := $own }}{{ $_ := set $robot $name $value }}{{ end -}}
{{- $_ := set $robot "security" (dict "enabled" .robot.security.enabled "enclave" "") -}}
{{- $_ := set $robot "settings" (dict "EDGEVOX_HEALTH_PORT" 8010 "EDGEVOX_METRICS_PORT" 0) -}}
- name: recorder
  image: {{ include "edgevox.image" .root | quote }}
  imagePullPolicy: {{ .root.Values.image.pullPolicy }}
  args: [edgevox-recorder, --output, /recordings]
  securityContext:
    allowPrivilegeEscalation: false
    readOnlyRootFilesystem: true
    capabilities:
      drop: [ALL]
  env:
    {{- include "edgevox.environment" (dict "root" .root "robot" $robot "robots" .robots) | trim | nindent 4 }}
  resources:
    {{- toYaml .robot.recorder.resources | nindent 4 }}
  volumeMounts:
    - name: tmp
      mountPath: /tmp
    # Shared with the robot: DDS takes two containers of one network for one machine.
    - name: shm
      mountPath: /dev/shm
    - name: recordings
      mountPath: /recordings
    {{- if .robot.security.enabled }}
    - name: recorder-security
      mountPath: /etc/edgevox/security/enclaves{{ include "edgevox.recorderEnclave" .robot }}
      readOnly: true
    {{- end }}
{{- end -}}

{{/* The recorder beside a robot, with its rights and its network. Takes root, robot and robots. */}}
{{- define "edgevox.recorder" -}}
{{- /* What it hears by is the robot's; what the robot is made of is not for it. */ -}}
{{- $own := dict "files" (dict "data" (dict) "configMap" "") "plugins" (dict "volume" (dict)) "policy" (dict) "env" (list) "console" (dict "enabled" false) -}}
{{- $none := dict "endpoint" "" "model" "none" -}}
{{- $robot := mergeOverwrite (deepCopy .robot) (dict "llm" $none "stt" $none "tts" $none "settings" (dict)) -}}
{{- $metrics := and .root.Values.serviceMonitor.enabled (not .robot.hostNetwork) -}}
{{- range $name, $value := $own }}{{ $_ := set $robot $name $value }}{{ end -}}
{{- $_ := set $robot "security" (dict "enabled" .robot.security.enabled "enclave" "") -}}
{{- $_ := set $robot "settings" (dict "EDGEVOX_HEALTH_PORT" (int .robot.recorder.healthPort) "EDGEVOX_METRICS_PORT" (ternary (int .robot.recorder.metricsPort) 0 $metrics)) -}}
{{- $kept := .robot.recorder -}}
{{- if and (eq $kept.whenFull "ring") (lt (int $kept.mostMb) (mul 2 (int $kept.fileMb) | int)) -}}
{{- fail (printf "recorder.mostMb: got %d, expected at least twice fileMb, %d" (int $kept.mostMb) (mul 2 (int $kept.fileMb))) -}}
{{- end }}
- name: recorder
  image: {{ include "edgevox.image" .root | quote }}
  imagePullPolicy: {{ .root.Values.image.pullPolicy }}
  args:
    - edgevox-recorder
    - --output=/recordings
    - --most={{ int $kept.mostMb }}
    - --max-size={{ int $kept.fileMb }}
    - --spare={{ int $kept.spareMb }}
    - --when-full={{ $kept.whenFull }}
  securityContext:
    allowPrivilegeEscalation: false
    readOnlyRootFilesystem: true
    capabilities:
      drop: [ALL]
  env:
    {{- include "edgevox.environment" (dict "root" .root "robot" $robot "robots" .robots) | trim | nindent 4 }}
  {{- if $metrics }}
  ports:
    - name: rec-metrics
      containerPort: {{ int $kept.metricsPort }}
  {{- end }}
  # A recorder that is frozen starts again and mends its files. A full disk does not end it: see its log and metrics.
  livenessProbe:
    {{- if .robot.hostNetwork }}
    exec:
      command: [edgevox-health, --live]
    {{- else }}
    httpGet:
      path: /live
      port: {{ int $kept.healthPort }}
    {{- end }}
    periodSeconds: 10
    timeoutSeconds: 3
    failureThreshold: 6
  resources:
    {{- include "edgevox.resources" (dict "resources" $kept.resources "diskMb" 50) | nindent 4 }}
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

{{/* rclone beside a robot's recorder: what is written no more goes to object storage. Takes root and robot. */}}
{{- define "edgevox.upload" -}}
{{- $upload := .robot.recorder.upload -}}
- name: upload
  image: {{ $upload.image | quote }}
  imagePullPolicy: IfNotPresent
  command: [sh, -c]
  # As in compose/recordings.yml. What has its own name is whole and never changes.
  args:
    - >-
      touch /tmp/ended; while true; do echo "$UPLOAD_EVERY_S" >/tmp/began;
      if rclone --config /run/secrets/rclone/rclone.conf "$UPLOAD_VERB" /recordings "$UPLOAD_TO"
      --include '*.{mcap,yaml}' --immutable --s3-no-check-bucket --log-level NOTICE --max-duration 30m
      --retries 1 --low-level-retries 5 --contimeout 15s;
      then rm -f /recordings/upload.failed && cp -p /tmp/began /recordings/upload.done;
      else touch /recordings/upload.failed; fi; noted=$?;
      touch /tmp/ended; sleep "$UPLOAD_EVERY_S"; [ $noted -eq 0 ] || exit 1; done
  env:
    - {name: UPLOAD_VERB, value: {{ ternary "move" "copy" $upload.move }}}
    - {name: UPLOAD_TO, value: {{ printf "%s/%s" (trimSuffix "/" $upload.to) .robot.name | quote }}}
    - {name: UPLOAD_EVERY_S, value: {{ $upload.everySeconds | quote }}}
    - {name: XDG_CACHE_HOME, value: /tmp}
  securityContext:
    allowPrivilegeEscalation: false
    readOnlyRootFilesystem: true
    capabilities:
      drop: [ALL]
  # Restarted where no run has ended for two hours. A run that fails does not make the robot unready.
  livenessProbe:
    exec: {command: [sh, -c, 'test -z "$(find /tmp/ended -mmin +{{ add 120 (div (int $upload.everySeconds) 60) }})"']}
    periodSeconds: 60
    failureThreshold: 3
  resources:
    {{- include "edgevox.resources" (dict "resources" $upload.resources "diskMb" 80) | nindent 4 }}
  volumeMounts:
    - name: upload-tmp
      mountPath: /tmp
    - name: recordings
      mountPath: /recordings
    - name: upload-config
      mountPath: /run/secrets/rclone
      readOnly: true
{{- end -}}

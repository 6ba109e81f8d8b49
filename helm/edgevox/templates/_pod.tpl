{{/* Whom a pod runs as, and what its volumes belong to. Takes root. */}}
{{- define "edgevox.user" -}}
runAsNonRoot: true
runAsUser: {{ .Values.user.uid | int }}
runAsGroup: {{ .Values.user.gid | int }}
fsGroup: {{ .Values.user.gid | int }}
fsGroupChangePolicy: OnRootMismatch
{{- with .Values.user.groups }}
supplementalGroups: {{ toJson . }}
{{- end }}
seccompProfile:
  type: RuntimeDefault
{{- end -}}

{{/* Where a robot's pod may run, on which network, and with whose name. Takes root and robot. */}}
{{- define "edgevox.placement" -}}
{{- with .root.Values.serviceAccountName }}
serviceAccountName: {{ . }}
{{- end }}
{{- with .root.Values.image.pullSecrets }}
imagePullSecrets:
{{- range . }}
  - name: {{ . }}
{{- end }}
{{- end }}
{{- if .robot.hostNetwork }}
hostNetwork: true
dnsPolicy: ClusterFirstWithHostNet
{{- end }}
{{- range $field := list "priorityClassName" "runtimeClassName" }}
{{- with index $.robot $field }}
{{ $field }}: {{ . }}
{{- end }}
{{- end }}
{{- range $field := list "nodeSelector" "affinity" }}
{{- with index $.robot $field }}
{{ $field }}:
  {{- toYaml . | nindent 2 }}
{{- end }}
{{- end }}
tolerations:
  {{- with .robot.tolerations }}
  {{- toYaml . | nindent 2 }}
  {{- end }}
  {{- include "edgevox.outOfReach" .robot | nindent 2 }}
{{- with .robot.topologySpreadConstraints }}
topologySpreadConstraints:
  {{- range . }}
  - {{ include "edgevox.spread" (dict "root" $.root "constraint" .) | nindent 4 | trim }}
  {{- end }}
{{- end }}
{{- end -}}

{{/* A robot out of the radio's reach goes on: evicted after five minutes, as Kubernetes would have it,
     it would run nowhere else, and be stopped on its way as soon as it is heard of again. */}}
{{- define "edgevox.outOfReach" -}}
{{- $named := list -}}
{{- range .tolerations }}{{ $named = append $named .key }}{{ end -}}
{{- range list "node.kubernetes.io/unreachable" "node.kubernetes.io/not-ready" }}
{{- if not (has . $named) }}
- {key: {{ . }}, operator: Exists, effect: NoExecute}
{{- end }}
{{- end }}
{{- end -}}

{{/* A constraint, of all robots of the release if it does not say of which pods. */}}
{{- define "edgevox.spread" -}}
{{- $robots := dict "matchLabels" (include "edgevox.selector" .root | fromYaml) -}}
{{- toYaml (merge (deepCopy .constraint) (ternary (dict) (dict "labelSelector" $robots) (hasKey .constraint "labelSelector"))) -}}
{{- end -}}

{{/* What a container asks for, with the node's disk, so that a full node does not evict it first. Takes resources and diskMb. */}}
{{- define "edgevox.resources" -}}
{{- $disk := dict "requests" (dict "ephemeral-storage" (printf "%dM" (int .diskMb))) -}}
{{- toYaml (merge (deepCopy .resources) $disk) -}}
{{- end -}}

{{/* How health is asked: from outside the pod, or within it where outside is the whole LAN. */}}
{{- define "edgevox.probe" -}}
{{- if .robot.hostNetwork -}}
exec:
  command: [edgevox-health, --{{ .what }}]
{{- else -}}
httpGet:
  path: /{{ .what }}
  port: health
{{- end -}}
{{- end -}}

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
{{- range $field := list "nodeSelector" "tolerations" "affinity" "topologySpreadConstraints" }}
{{- with index $.robot $field }}
{{ $field }}:
  {{- toYaml . | nindent 2 }}
{{- end }}
{{- end }}
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

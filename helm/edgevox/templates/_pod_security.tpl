{{/* Which of a robot's values a namespace that holds to "restricted" does not admit. */}}
{{- define "edgevox.notRestricted" -}}
{{- $robot := . -}}
{{- $admitted := list "name" "configMap" "csi" "downwardAPI" "emptyDir" "ephemeral" "image" "persistentVolumeClaim" "projected" "secret" -}}
{{- $found := ternary (list "hostNetwork") (list) .hostNetwork -}}
{{- $volumes := dict "extraVolumes" .extraVolumes -}}
{{- range $part := concat (list "models" "places" "plugins") (ternary (list "recorder") (list) .recorder.enabled) -}}
{{- $_ := set $volumes (printf "%s.volume" $part) (list (index $robot $part).volume) -}}
{{- end -}}
{{- range $name, $sources := $volumes -}}
{{- range $sources -}}
{{- range $key, $_ := . -}}
{{- if not (has $key $admitted) }}{{ $found = append $found $name }}{{ end -}}
{{- end -}}
{{- end -}}
{{- end -}}
{{- join ", " ($found | uniq) -}}
{{- end -}}

{{/* Which of a robot's values a namespace that holds to "restricted" does not admit. */}}
{{- define "edgevox.notRestricted" -}}
{{- $admitted := list "name" "configMap" "csi" "downwardAPI" "emptyDir" "ephemeral" "image" "persistentVolumeClaim" "projected" "secret" -}}
{{- $found := ternary (list "hostNetwork") (list) .hostNetwork -}}
{{- $volumes := dict "extraVolumes" .extraVolumes -}}
{{- range $name, $part := . -}}
{{- if kindIs "map" $part -}}
{{- if and $part.volume (dig "enabled" true $part) -}}
{{- $_ := set $volumes (printf "%s.volume" $name) (list $part.volume) -}}
{{- end -}}
{{- end -}}
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

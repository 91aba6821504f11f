# Sourced by the scripts that run in stages: says what is being done, how long each stage took, and which one failed.
set -Eeuo pipefail

stage_name="starting"
stage_begin=$SECONDS
stage_lines=()

# Ends the stage before, if any, and begins the one named "$1".
stage() {
    end_stage
    stage_name=$1
    stage_begin=$SECONDS
    printf '\n=== %s\n' "$stage_name"
}

end_stage() {
    [ "$stage_name" = "starting" ] || stage_lines+=("$(printf '%5d s  %s' $((SECONDS - stage_begin)) "$stage_name")")
    stage_name="starting"
}

# Ends the last stage and prints how long each took.
print_stages() {
    end_stage
    printf '\n=== Durations on %s cores\n' "$(nproc)"
    printf '%s\n' "${stage_lines[@]}" "$(printf '%5d s  together' "$SECONDS")"
}

# Runs a command after showing it.
show() {
    printf '+ %s\n' "$(printf '%q ' "$@")"
    "$@"
}

trap 'printf "\n%s: FAILED while: %s (line %s: %s)\n" "$0" "$stage_name" "$LINENO" "$BASH_COMMAND" >&2' ERR

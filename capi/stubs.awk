# Reads the public headers and writes, for the halves that a build leaves out, the functions that say so.
# -v sim=0|1 -v learn=0|1 -v policy=0|1: which halves there are, and whether frozen policies run. A function belongs to a half by its name; one of agents that
# takes a pool needs both, one of policies that takes an agent learners; recordings are in either. The two config_init functions are in every build, and what has no half is too.
# -v old=1, of deprecated.h: the functions of 0.1 that have another name now, for programs that were linked with it; without
# -v stubs=1 those of a half that is left out do not exist.
# -v names=1: the names alone of what a build without such functions leaves out, config_init and the like among them; one of policies alone has
# those of base.h and policy.h. Lists of symbols may be given too.
function half_of(name, parameters) {
  if (names && name ~ /^rdm_(clone|pretrain)_/) return learn ? "" : "learning"
  if (names && name ~ /^rdm_(fail|rotation)$/) return sim ? "" : "simulation"
  if (names && !sim && !learn && name ~ /^rdm_(actor_|policy_(act_points|act_state|act_points_state|group_name|write_group)$)/) return "learning"
  if (!names && name ~ /^rdm_(pool|agent)_config_init$/) return ""
  if (name ~ /^rdm_recording_/) return !sim && parameters ~ /rdm_pool/ ? "simulation" : sim || learn ? "" : "learning"
  if (name ~ /^rdm_agent_/ && parameters ~ /rdm_(pool|shield)/) return sim ? (learn ? "" : "learning") : "simulation"
  if (name ~ /^rdm_(task|robot|object|pool|planner|shield|map|sample|scene|contact|world|random)_/) return sim ? "" : "simulation"
  if (name == "rdm_project") return sim ? "" : "simulation"
  if (name == "rdm_policy_update_from") return learn ? "" : "learning"
  if (name ~ /^rdm_(policy|actor)_/) return policy ? "" : "learning"
  if (name ~ /^rdm_(algo|agent|checkpoint)_/) return learn ? "" : "learning"
  return ""
}

function body_of(type, half, parameters) {
  if (type == "void") return "{}"
  if (type == "rdm_result" && parameters ~ /const rdm_[a-z]+_config \*c/) return "{\n  return left_out(\"" half "\", c);\n}"
  if (type == "rdm_result") return "{\n  return left_out(\"" half "\");\n}"
  if (type ~ /char/) return "{\n  return \"this build was made without the " half " half\";\n}"
  return "{\n  return 0;\n}"
}

function declared(text,   type, name, parameters, half) {
  gsub(/\/\*[^*]*\*+([^\/*][^*]*\*+)*\//, "", text)
  gsub(/[ \t]+/, " ", text)
  sub(/^RDM_API /, "", text)
  sub(/ *;.*/, "", text)
  match(text, /rdm_[a-z_0-9]+\(/)
  type = substr(text, 1, RSTART - 1)
  name = substr(text, RSTART, RLENGTH - 1)
  parameters = substr(text, RSTART + RLENGTH)
  sub(/ $/, "", type)
  half = half_of(name, parameters)
  if (old) { if (half == "" || stubs) print "RDM_API " body }
  else if (half != "") print names ? name : text " " body_of(type, half, parameters)
}

BEGIN {
  if (old) print "// The names of 0.1. Written by capi/stubs.awk from redman/deprecated.h.\n#include \"redman/deprecated.h\"\n\nextern \"C\" {"
  else if (!names) print_head()
}
END { if (old) print "}" }
function print_head() {
  print "// The functions of the halves that this build leaves out: they exist and say so. Written by capi/stubs.awk."
  print "#include \"capi/abi_call.hpp\"\n\n#pragma GCC diagnostic ignored \"-Wunused-parameter\"\n"
  print "static rdm_result left_out(const char* half) {"
  print "  return rdm::capi::call([half] { rdm::capi::left_out(half); });\n}"
  print "template <class Config>\nstatic rdm_result left_out(const char* half, const Config* c) {"
  print "  return rdm::capi::call_with(c, [half] { rdm::capi::left_out(half); });\n}"
}
{ sub(/\r$/, "") }
names && /^rdm_[a-z_0-9]+$/ && half_of($0, "") != "" { print; next }
old && /names that no release had/ { exit }  # no symbols for those, and the experimental ones behind them
old && /^static inline/ { body = " "; next }
old && body != "" {
  body = body == " " ? $0 : body "\n" $0
  if (/^}/) { declared(substr(body, 1, index(body, "{") - 1) ";"); body = "" }
  next
}
old { next }
statement == "" && /^RDM_API/ { statement = " " }
statement != "" {
  statement = statement " " $0
  if (/;/) { sub(/^ */, "", statement); declared(statement); statement = "" }
}

// The part of an agent's config that two agents must share to exchange states.
#pragma once
#include "algos/core/resolved_config.hpp"
#include "base/bytes.hpp"

namespace rdm {

void write_fingerprint(Writer& out, const ResolvedAgentConfig& resolved);
// Error(kFormat) that names the first field that differs from the resolved's. Live options need not agree:
// with `apply` the resolved takes them over.
void read_fingerprint(Reader& in, ResolvedAgentConfig& resolved, bool apply);

}  // namespace rdm

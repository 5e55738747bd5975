// The part of an agent's config that two agents must share to exchange states.
#pragma once
#include "algos/core/resolved_config.hpp"
#include "base/bytes.hpp"

namespace rdm {

void write_fingerprint(Writer& out, const ResolvedAgentConfig& plan);
// Error(kFormat) that names the first field that differs from the plan's. Live options need not agree: with
// `apply` the plan takes them over.
void read_fingerprint(Reader& in, ResolvedAgentConfig& plan, bool apply);

}  // namespace rdm

// Pages that a browser opens from a file: one file each, with all that it needs inside and nothing fetched.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "play/playback.hpp"

namespace tool {

// What the build put into the tool: our own pages and scripts, and the viewer library as "three".
struct WebAsset {
  const char *name, *text;
};
extern const WebAsset kWebAssets[];  // a null name ends the list

// The asset "<name>" with each "{{part}}" replaced by the text of that name, else by the asset of that name.
// Failure when there is neither.
std::string filled_page(const std::string& name, const std::map<std::string, std::string>& parts);

// Text as JSON in a <script> may have it, bytes as base64.
std::string script_json(const std::string& json);
std::string base64(const void* bytes, size_t size);

// Failure when this build has no viewer library.
void check_viewer();
// The episode in 3D, to be turned, played and scrubbed, above its reward and costs. `camera` is the one to
// begin with.
std::string playback_page(const Playback& playback, const std::string& camera);

}  // namespace tool

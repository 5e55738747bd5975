// The page of one episode.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/names.hpp"
#include "common/report.hpp"
#include "common/text.hpp"
#include "web/glb.hpp"
#include "web/page.hpp"

namespace tool {
namespace {

template <class T>
std::string base64_of(const std::vector<T>& values) {
  return base64(values.data(), values.size() * sizeof(T));
}

std::vector<float> column(const std::vector<float>& rows, size_t width, size_t k) {
  std::vector<float> out;
  for (size_t i = k; i < rows.size(); i += width) out.push_back(rows[i]);
  return out;
}

Json curve_json(const std::string& name, const std::string& help, double limit,
                const std::vector<float>& step, const std::vector<float>& sum) {
  return {{"name", name},
          {"help", help},
          {"limit", limit < 0 ? Json() : Json(limit)},
          {"step", base64_of(step)},
          {"sum", base64_of(sum)}};
}

Json curves_json(const Playback& p) {
  Json out = Json::array();
  out.push_back(
      curve_json("return", "sum of rewards; bars: the reward of each step", -1, p.reward, p.episode_return));
  for (size_t k = 0; k < p.costs.size(); ++k) {
    const CostCurve& c = p.costs[k];
    out.push_back(curve_json(c.name, c.help, c.limit, column(p.cost, p.costs.size(), k),
                             column(p.episode_cost, p.costs.size(), k)));
  }
  if (p.stepped_in.empty()) return out;
  std::vector<float> sum;
  for (const float x : p.stepped_in) sum.push_back(x + (sum.empty() ? 0 : sum.back()));
  out.push_back(
      curve_json("shield", "steps in which it did not let through what was proposed", -1, p.stepped_in, sum));
  return out;
}

// Points and forces as 16-bit integers of a unit each.
Json contacts_json(const Playback& p) {
  float reach = 1e-6f, newton = 1e-6f;
  for (const rdm_contact& c : p.contacts)
    for (size_t i = 0; i < 3; ++i) {
      reach = std::max(reach, std::abs(c.position[i]));
      newton = std::max(newton, std::abs(c.force[i]));
    }
  std::vector<int16_t> at, force;
  for (const rdm_contact& c : p.contacts)
    for (size_t i = 0; i < 3; ++i) {
      at.push_back(static_cast<int16_t>(std::lround(c.position[i] / reach * 32767)));
      force.push_back(static_cast<int16_t>(std::lround(c.force[i] / newton * 32767)));
    }
  return {
      {"unit", reach / 32767}, {"xyz", base64_of(at)}, {"force", base64_of(force)}, {"end", p.contacts_end}};
}

Json camera_json(const rdm_camera_info& c) {
  return {{"name", c.name}, {"eye", c.eye}, {"target", c.target}, {"fov_y", c.fov_y}};
}

}  // namespace

std::string playback_page(const Playback& p, const std::string& camera) {
  check_viewer();
  const std::string glb = glb_bytes(p);
  Json cameras = Json::array(), success = Json::array();
  std::string first;
  for (const rdm_camera_info& c : p.cameras) {
    cameras.push_back(camera_json(c));
    if (same_name(camera, c.name)) first = c.name;
  }
  for (size_t k = 0; k < p.frames; ++k)
    if (p.success[k]) success.push_back(k);
  Json stepped_in = Json::array();
  for (size_t k = 0; k < p.stepped_in.size(); ++k)
    if (p.stepped_in[k] > 0) stepped_in.push_back(k);
  const Json episode = {{"task", p.task},
                        {"actor", p.actor},
                        {"seed", p.seed},
                        {"dt", p.control_dt},
                        {"first", p.first_step},
                        {"frames", p.frames},
                        {"shapes", p.bodies.size()},
                        {"terminated", p.terminated},
                        {"success", success},
                        {"stepped_in", stepped_in},
                        {"camera", first},
                        {"cameras", cameras},
                        {"curves", curves_json(p)},
                        {"contacts", contacts_json(p)},
                        {"glb", base64(glb.data(), glb.size())}};
  std::string about =
      format("policy %s, seed %llu, %zu frames of %s s", p.actor.c_str(),
             static_cast<unsigned long long>(p.seed), p.frames, format("%.4g", p.control_dt).c_str());
  if (!p.shield.empty())
    about += format("; shield %s, a red border where it stepped in, in %zu frames", p.shield.c_str(),
                    stepped_in.size());
  return filled_page("player.html", {{"title", html_text(p.task + ", " + p.actor)},
                                     {"task", html_text(p.task)},
                                     {"about", html_text(about)},
                                     {"episode", script_json(json_text(episode))}});
}

}  // namespace tool

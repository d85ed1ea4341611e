#include "core/motion/motion.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/motion/kinematics.h"
#include "core/motion/rate_limits.h"

namespace mocurate {
namespace {

FrameRate Reduced(std::int64_t numerator, std::int64_t denominator) {
  const std::int64_t divisor = std::gcd(numerator, denominator);
  return FrameRate{numerator / divisor, denominator / divisor};
}

tl::unexpected<Error> BrokenMotion(const std::string& what) { return Fail(ErrorCode::kInconsistent, what, "motion"); }

Status CheckShapes(const Motion& m) {
  const std::size_t frames = static_cast<std::size_t>(m.frame_count());
  const std::size_t joints = m.skeleton->joints.size();
  if (m.joint_count() != m.skeleton->joint_count()) {
    return BrokenMotion(std::to_string(m.joint_count()) + " joints, but skeleton '" + m.skeleton->name + "' has " +
                        std::to_string(joints));
  }
  const auto shape = [](const char* field, std::size_t size, std::size_t expected, bool optional) -> Status {
    if (size == expected || (optional && size == 0)) return {};
    return BrokenMotion(std::string(field) + " has " + std::to_string(size) + " entries, " + std::to_string(expected) +
                        " are needed");
  };
  const std::size_t full = m.joints_only() ? 0 : 1;
  const std::size_t cells = frames * joints;
  if (Status ok = shape("joints", m.joints.xyz.size(), cells * 3, false); !ok) return ok;
  if (Status ok = shape("rotation", m.rotation.size(), cells * full, false); !ok) return ok;
  if (Status ok = shape("root_translation", m.root_translation.size(), frames * full, false); !ok) return ok;
  if (Status ok = shape("bone_length", m.bone_length.size(), joints * full, false); !ok) return ok;
  if (Status ok = shape("state", m.state.size(), cells, true); !ok) return ok;
  if (Status ok = shape("position_cov", m.position_cov.size(), cells * 6, true); !ok) return ok;
  if (Status ok = shape("rotation_sigma", m.rotation_sigma.size(), cells * 3, true); !ok) return ok;
  if (Status ok = shape("rotation_observed", m.rotation_observed.size(), cells * 3, true); !ok) return ok;
  return shape("contact", m.contact.size(), frames * 2, true);
}

template <class T>
Status CheckFinite(const char* field, const std::vector<T>& values) {
  const auto bad = std::find_if(values.begin(), values.end(), [](T v) { return !std::isfinite(v); });
  if (bad == values.end()) return {};
  return BrokenMotion(std::string(field) + " is not finite at index " + std::to_string(bad - values.begin()));
}

Status CheckNumbers(const Motion& m) {
  if (Status ok = CheckFinite("joints", m.joints.xyz); !ok) return ok;
  if (Status ok = CheckFinite("bone_length", m.bone_length); !ok) return ok;
  if (Status ok = CheckFinite("position_cov", m.position_cov); !ok) return ok;
  if (Status ok = CheckFinite("rotation_sigma", m.rotation_sigma); !ok) return ok;
  if (Status ok = CheckFinite("rotation_observed", m.rotation_observed); !ok) return ok;
  for (std::size_t i = 0; i < m.rotation.size(); ++i) {
    const double norm = m.rotation[i].norm();
    if (std::abs(norm - 1.0) <= 1e-6) continue;
    const std::size_t joints = m.skeleton->joints.size();
    return BrokenMotion("rotation of frame " + std::to_string(i / joints) + ", joint '" +
                        m.skeleton->joints[i % joints].name + "' has norm " + FormatDouble(norm) + ", not 1");
  }
  for (std::size_t j = 0; j < m.bone_length.size(); ++j) {
    if (m.bone_length[j] < 0.0)
      return BrokenMotion("bone of '" + m.skeleton->joints[j].name + "' has a negative length");
  }
  return {};
}

Status CheckKinematics(const Motion& m) {
  const Motion computed = MakeMotion(m.skeleton, m.rate, m.root_translation, m.rotation, m.bone_length);
  for (int f = 0; f < m.frame_count(); ++f) {
    for (int j = 0; j < m.joint_count(); ++j) {
      const double distance = (m.joints.at(f, j) - computed.joints.at(f, j)).norm();
      if (distance <= 1e-6) continue;
      return BrokenMotion("joint '" + m.skeleton->joints[j].name + "' of frame " + std::to_string(f) + " lies " +
                          FormatDouble(distance) + " m from its forward kinematics");
    }
  }
  return {};
}

}  // namespace

Expected<FrameRate> FrameRate::Parse(std::string_view text) {
  const auto malformed = [&] {
    return Fail(ErrorCode::kMalformed, "'" + std::string(text) + "' is no frame rate", {},
                "write frames per second, from 0.001 to 100000, as 30, 29.97, 120000/1001, 25 fps or 1 kHz");
  };
  const auto in_range = [](double hz) { return hz >= kSlowestRate_hz && hz <= kFastestRate_hz; };
  std::string_view number = Trim(text);
  std::int64_t factor = 1;
  for (const std::pair<std::string_view, std::int64_t>& unit :
       {std::pair<std::string_view, std::int64_t>{"kHz", 1000}, {"Hz", 1}, {"fps", 1}}) {
    if (number.size() < unit.first.size() || number.substr(number.size() - unit.first.size()) != unit.first) continue;
    number.remove_suffix(unit.first.size());
    factor = unit.second;
    break;
  }
  const std::vector<std::string_view> parts = SplitText(Trim(number), '/');
  if (parts.size() > 2) return malformed();
  if (parts.size() == 2) {
    const auto numerator = ParseInteger(Trim(parts[0]));
    const auto denominator = ParseInteger(Trim(parts[1]));
    if (!numerator || !denominator || *numerator <= 0 || *denominator <= 0) return malformed();
    if (*numerator > 1000000000000) return malformed();
    const FrameRate rate = Reduced(*numerator * factor, *denominator);
    return in_range(rate.hz()) ? Expected<FrameRate>(rate) : malformed();
  }
  const auto hz = ParseDouble(Trim(number));
  if (!hz || !in_range(*hz * static_cast<double>(factor))) return malformed();
  return FromHz(*hz * static_cast<double>(factor));
}

FrameRate FrameRate::FromHz(double hz) {
  const std::int64_t whole = std::llround(hz);
  const std::int64_t ntsc = std::llround(hz * 1001.0 / 1000.0) * 1000;
  const double whole_error = std::abs(static_cast<double>(whole) - hz);
  const double ntsc_error = std::abs(static_cast<double>(ntsc) / 1001.0 - hz);
  if (whole > 0 && whole_error <= 1e-4 * hz && whole_error <= ntsc_error) return FrameRate{whole, 1};
  if (ntsc > 0 && ntsc_error <= 1e-4 * hz) return FrameRate{ntsc, 1001};
  return Reduced(std::max<std::int64_t>(1, std::llround(hz * 1e6)), 1000000);
}

std::string FrameRate::Text() const {
  return denominator == 1 ? std::to_string(numerator) : std::to_string(numerator) + "/" + std::to_string(denominator);
}

bool operator==(const FrameRate& a, const FrameRate& b) {
  const FrameRate left = Reduced(a.numerator, a.denominator);
  const FrameRate right = Reduced(b.numerator, b.denominator);
  return left.numerator == right.numerator && left.denominator == right.denominator;
}

Status Motion::Check() const {
  if (!skeleton) return BrokenMotion("there is no skeleton");
  if (rate.numerator <= 0 || rate.denominator <= 0)
    return BrokenMotion("frame rate " + rate.Text() + " is not positive");
  if (Status ok = CheckShapes(*this); !ok) return ok;
  if (Status ok = CheckNumbers(*this); !ok) return ok;
  return joints_only() ? Status{} : CheckKinematics(*this);
}

std::string MotionFingerprint(const Motion& motion) {
  Sha256 hasher;
  hasher.Add(motion.rate.Text() + " " + std::to_string(motion.frame_count()) + " " +
             std::to_string(motion.joint_count()) + "\n");
  const std::vector<float> stored(motion.joints.xyz.begin(), motion.joints.xyz.end());
  hasher.Add(stored.data(), stored.size() * sizeof(float));
  return hasher.Hex().substr(0, 16);
}

}  // namespace mocurate

#include "canon/trim/body_description.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "canon/trim/trim.h"
#include "core/motion/heading.h"

namespace mocurate {
namespace {

constexpr Eigen::Index kXyz = 3;

/// Joints in the world at `time_s`, (3 J).
void SampleJoints(const Motion& motion, double time_s, double sigma_s, Eigen::Ref<Eigen::RowVectorXd> sample) {
  const double middle = time_s * motion.rate.hz();
  const double reach = 3.0 * sigma_s * motion.rate.hz();
  const int first = std::max(0, static_cast<int>(std::ceil(middle - reach)));
  const int last = std::min(motion.frame_count() - 1, static_cast<int>(std::floor(middle + reach)));
  double total = 0.0;
  sample.setZero();
  for (int f = first; f <= last; ++f) {
    const double off = (f - middle) / (sigma_s * motion.rate.hz());
    const double weight = std::exp(-0.5 * off * off);
    total += weight;
    sample += weight * Eigen::Map<const Eigen::RowVectorXd>(motion.joints.at(f, 0).data(), sample.cols());
  }
  sample /= total;
}

/// Yaw of each sample; where the left-right axis is nearly vertical, that of the sample before.
std::vector<double> Yaws(const SampleMatrix& joints, const std::array<int, 2>& sides) {
  std::vector<double> yaws;
  double yaw = 0.0;
  for (Eigen::Index s = 0; s < joints.rows(); ++s) {
    const Eigen::RowVector3d left = joints.block<1, 3>(s, kXyz * sides[0]) - joints.block<1, 3>(s, kXyz * sides[1]);
    if (std::hypot(left.x(), left.z()) > kLeastHorizontal * left.norm()) yaw = std::atan2(-left.z(), left.x());
    yaws.push_back(yaw);
  }
  return yaws;
}

}  // namespace

BodyDescription DescribeBody(const Motion& motion, double rate_hz, double smoothing_s) {
  BodyDescription body;
  body.rate_hz = rate_hz;
  const int frames = motion.frame_count(), joints = motion.joint_count();
  const int samples =
      frames == 0 ? 0 : static_cast<int>(std::floor(motion.rate.FrameTime(frames - 1) * rate_hz + 1e-9)) + 1;
  const double sigma_s = std::max(smoothing_s, 0.5 / motion.rate.hz());
  body.pose.resize(samples, kXyz * joints);
  body.speed.setZero(samples, joints);
  body.movement.setZero(samples);
  if (samples == 0) return body;
  for (int s = 0; s < samples; ++s) SampleJoints(motion, s / rate_hz, sigma_s, body.pose.row(s));
  for (int s = 0; s < samples && samples > 1; ++s) {
    const int before = std::max(0, s - 1), after = std::min(samples - 1, s + 1);
    const Eigen::RowVectorXd step = (body.pose.row(after) - body.pose.row(before)) * (rate_hz / (after - before));
    for (int j = 0; j < joints; ++j) body.speed(s, j) = step.segment<3>(kXyz * j).norm();
  }
  const std::vector<double> movement = FrameSpeeds(motion, kSpeedWindow_s);
  for (int s = 0; s < samples; ++s) {
    const auto frame = static_cast<std::size_t>(std::lround(s / rate_hz * motion.rate.hz()));
    body.movement(s) = movement[std::min(frame, movement.size() - 1)];
  }
  const auto sides = HipsOrShoulders(*motion.skeleton);
  const std::vector<double> yaws =
      sides ? Yaws(body.pose, *sides) : std::vector<double>(static_cast<std::size_t>(samples), 0.0);
  for (int s = 0; s < samples; ++s) {
    const double cosine = std::cos(yaws[static_cast<std::size_t>(s)]),
                 sine = std::sin(yaws[static_cast<std::size_t>(s)]);
    Eigen::RowVector3d middle = body.pose.block<1, 3>(s, 0);
    if (sides)
      middle = 0.5 * (body.pose.block<1, 3>(s, kXyz * (*sides)[0]) + body.pose.block<1, 3>(s, kXyz * (*sides)[1]));
    for (int j = 0; j < joints; ++j) {
      const Eigen::RowVector3d from = body.pose.block<1, 3>(s, kXyz * j) - middle;
      body.pose.block<1, 3>(s, kXyz * j) << cosine * from.x() - sine * from.z(), from.y(),
          sine * from.x() + cosine * from.z();
    }
  }
  return body;
}

SampleMatrix SmoothRows(const SampleMatrix& rows, double sigma) {
  if (sigma <= 0.0) return rows;
  const int reach = static_cast<int>(std::ceil(3.0 * sigma));
  SampleMatrix smooth = SampleMatrix::Zero(rows.rows(), rows.cols());
  for (Eigen::Index s = 0; s < rows.rows(); ++s) {
    double total = 0.0;
    for (Eigen::Index r = std::max<Eigen::Index>(0, s - reach); r <= std::min(rows.rows() - 1, s + reach); ++r) {
      const double off = static_cast<double>(r - s) / sigma;
      const double weight = std::exp(-0.5 * off * off);
      total += weight;
      smooth.row(s) += weight * rows.row(r);
    }
    smooth.row(s) /= total;
  }
  return smooth;
}

double PoseDistance(const Eigen::Ref<const Eigen::RowVectorXd>& a, const Eigen::Ref<const Eigen::RowVectorXd>& b) {
  const Eigen::Index joints = a.cols() / 3;
  std::vector<double> squares(static_cast<std::size_t>(joints));
  for (Eigen::Index j = 0; j < joints; ++j) {
    squares[static_cast<std::size_t>(j)] = (a.segment<3>(kXyz * j) - b.segment<3>(kXyz * j)).squaredNorm();
  }
  const std::ptrdiff_t most = std::min(joints, std::max<Eigen::Index>(2, joints / 6));
  std::partial_sort(squares.begin(), squares.begin() + most, squares.end(), std::greater<>());
  double sum = 0.0;
  for (std::ptrdiff_t k = 0; k < most; ++k) sum += squares[static_cast<std::size_t>(k)];
  return most == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(most));
}

}  // namespace mocurate

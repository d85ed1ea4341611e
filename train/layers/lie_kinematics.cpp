#include "train/layers/lie_kinematics.h"

#include <algorithm>
#include <cmath>

namespace mocurate {
namespace {

// R = I + a [w] + b [w]^2 with a = sin t / t, b = (1 - cos t) / t^2, t^2 = max(|w|^2, floor); da, db by t^2.
struct Rodrigues {
  double a, b, da, db;
};

Rodrigues Coefficients(double square, double floor) {
  const bool frozen = square < floor;
  if (frozen) square = floor;
  Rodrigues r;
  if (square < 1e-6) {
    r = {1.0 - square / 6.0, 0.5 - square / 24.0, -1.0 / 6.0 + square / 60.0, -1.0 / 24.0 + square / 360.0};
  } else {
    const double angle = std::sqrt(square);
    const double sine = std::sin(angle), cosine = std::cos(angle);
    r.a = sine / angle;
    r.b = (1.0 - cosine) / square;
    if (square < 1e-2) {  // the difference above loses digits here
      const double half = std::sin(0.5 * angle);
      r.b = 2.0 * half * half / square;
    }
    r.da = (cosine - r.a) / (2.0 * square);
    r.db = (0.5 * r.a - r.b) / square;
    if (square < 1e-3) {  // the differences above lose digits here
      r.da = -1.0 / 6.0 + square / 60.0 - square * square / 1680.0;
      r.db = -1.0 / 24.0 + square / 360.0 - square * square / 13440.0;
    }
  }
  if (frozen) r.da = r.db = 0.0;
  return r;
}

void Exp(const double* w, const Rodrigues& c, double* R) {
  const double xx = w[0] * w[0], yy = w[1] * w[1], zz = w[2] * w[2];
  const double xy = c.b * w[0] * w[1], xz = c.b * w[0] * w[2], yz = c.b * w[1] * w[2];
  R[0] = 1.0 - c.b * (yy + zz);
  R[1] = xy - c.a * w[2];
  R[2] = xz + c.a * w[1];
  R[3] = xy + c.a * w[2];
  R[4] = 1.0 - c.b * (xx + zz);
  R[5] = yz - c.a * w[0];
  R[6] = xz - c.a * w[1];
  R[7] = yz + c.a * w[0];
  R[8] = 1.0 - c.b * (xx + yy);
}

// Gradient of <G, R(w)> by w.
void ExpGradient(const double* w, const Rodrigues& c, const double* G, double* gradient) {
  const double square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
  const double trace = G[0] + G[4] + G[8];
  const double v[3] = {G[7] - G[5], G[2] - G[6], G[3] - G[1]};  // <G,[w]> = v.w
  const double s[3] = {2 * G[0] * w[0] + (G[1] + G[3]) * w[1] + (G[2] + G[6]) * w[2],
                       (G[1] + G[3]) * w[0] + 2 * G[4] * w[1] + (G[5] + G[7]) * w[2],
                       (G[2] + G[6]) * w[0] + (G[5] + G[7]) * w[1] + 2 * G[8] * w[2]};  // (G + G^T) w
  const double of_a = v[0] * w[0] + v[1] * w[1] + v[2] * w[2];
  const double of_b = 0.5 * (s[0] * w[0] + s[1] * w[1] + s[2] * w[2]) - square * trace;  // <G,[w]^2>
  const double along = 2.0 * (of_a * c.da + of_b * c.db);
  for (int i = 0; i < 3; ++i) gradient[i] = c.a * v[i] + c.b * (s[i] - 2.0 * trace * w[i]) + along * w[i];
}

void Multiply(const double* A, const double* B, double* C) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) C[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
  }
}

void TransposeMultiply(const double* A, const double* B, double* C) {  // A^T B
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) C[3 * i + j] = A[i] * B[j] + A[3 + i] * B[3 + j] + A[6 + i] * B[6 + j];
  }
}

void AddMultiplyTranspose(const double* A, const double* B, double* C) {  // C += A B^T
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      C[3 * i + j] += A[3 * i] * B[3 * j] + A[3 * i + 1] * B[3 * j + 1] + A[3 * i + 2] * B[3 * j + 2];
    }
  }
}

constexpr double kIdentity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

}  // namespace

LieLayer::LieLayer(const LieChains& chains, LieExp exp)
    : floor_(exp == LieExp::kReleased ? 1e-4 : 0.0), parent_(chains.raw_offsets.size(), 0) {
  for (const std::vector<int>& chain : chains.chains) {
    for (std::size_t i = 1; i < chain.size(); ++i) {
      Bone bone;
      bone.joint = chain[i];
      bone.parent = chain[i - 1];
      bone.starts_chain = i == 1;
      for (int k = 0; k < 3; ++k) bone.offset[k] = chains.raw_offsets[chain[i]][k];
      bones_.push_back(bone);
      parent_[chain[i]] = chain[i - 1];
    }
  }
}

void LieLayer::Forward(const float* parameters, const float* bone_length, int count, float* joints) const {
  const int J = joint_count();
  for (int n = 0; n < count; ++n) {
    const float* y = parameters + static_cast<std::size_t>(n) * 3 * J;
    const float* length = bone_length + static_cast<std::size_t>(n) * J;
    float* p = joints + static_cast<std::size_t>(n) * 3 * J;
    for (int k = 0; k < 3; ++k) p[k] = y[k];
    double R[9];
    for (const Bone& bone : bones_) {
      if (bone.starts_chain) std::copy(kIdentity, kIdentity + 9, R);
      const double w[3] = {y[3 * bone.joint], y[3 * bone.joint + 1], y[3 * bone.joint + 2]};
      double E[9], product[9];
      Exp(w, Coefficients(w[0] * w[0] + w[1] * w[1] + w[2] * w[2], floor_), E);
      Multiply(R, E, product);
      std::copy(product, product + 9, R);
      const double b = length[bone.joint];
      for (int k = 0; k < 3; ++k) {
        const double along = R[3 * k] * bone.offset[0] + R[3 * k + 1] * bone.offset[1] + R[3 * k + 2] * bone.offset[2];
        p[3 * bone.joint + k] = static_cast<float>(b * along + p[3 * bone.parent + k]);
      }
    }
  }
}

void LieLayer::Backward(const float* parameters, const float* bone_length, const float* joint_gradient, int count,
                        float* parameter_gradient) const {
  const int J = joint_count();
  const int bone_count = static_cast<int>(bones_.size());
  std::vector<double> E(9 * bones_.size()), R(9 * bones_.size()), g(3 * static_cast<std::size_t>(J));
  std::vector<Rodrigues> coefficients(bones_.size());
  for (int n = 0; n < count; ++n) {
    const std::size_t row = static_cast<std::size_t>(n) * 3 * J;
    const float* y = parameters + row;
    const float* length = bone_length + static_cast<std::size_t>(n) * J;
    float* out = parameter_gradient + row;
    for (int k = 0; k < 3 * J; ++k) g[k] = joint_gradient[row + k];
    for (int i = 0; i < bone_count; ++i) {
      const int j = bones_[i].joint;
      const double w[3] = {y[3 * j], y[3 * j + 1], y[3 * j + 2]};
      coefficients[i] = Coefficients(w[0] * w[0] + w[1] * w[1] + w[2] * w[2], floor_);
      Exp(w, coefficients[i], &E[9 * i]);
      Multiply(bones_[i].starts_chain ? kIdentity : &R[9 * (i - 1)], &E[9 * i], &R[9 * i]);
    }
    double G[9];  // gradient by the rotation at the current bone
    for (int i = bone_count - 1; i >= 0; --i) {
      const Bone& bone = bones_[i];
      if (i == bone_count - 1 || bones_[i + 1].starts_chain) std::fill(G, G + 9, 0.0);
      const double b = length[bone.joint];
      double* at_joint = &g[3 * bone.joint];
      for (int k = 0; k < 3; ++k) {
        for (int m = 0; m < 3; ++m) G[3 * k + m] += b * at_joint[k] * bone.offset[m];
        g[3 * bone.parent + k] += at_joint[k];
      }
      const double* before = bone.starts_chain ? kIdentity : &R[9 * (i - 1)];
      double of_exp[9], of_before[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
      TransposeMultiply(before, G, of_exp);
      AddMultiplyTranspose(G, &E[9 * i], of_before);
      const double w[3] = {y[3 * bone.joint], y[3 * bone.joint + 1], y[3 * bone.joint + 2]};
      double gradient[3];
      ExpGradient(w, coefficients[i], of_exp, gradient);
      for (int k = 0; k < 3; ++k) out[3 * bone.joint + k] = static_cast<float>(gradient[k]);
      std::copy(of_before, of_before + 9, G);
    }
    for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(g[k]);
  }
}

}  // namespace mocurate

#include "zwidth/mechanism/loaded_stiffness.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "zwidth/math/elimination.h"
#include "zwidth/mechanism/internal/posture_builder.h"

namespace zwidth {
namespace {

constexpr int kMaxFreedoms = kMaxLegJoints * 7;  // of a leg: every joint, and six of every link
using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxFreedoms, 1>;
using Rows6 = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxFreedoms>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxFreedoms + 6, kMaxFreedoms + 6>;

// One freedom of a leg in its present place.
struct Freedom {
  Vector3 axis, point;  // unit direction; a point on it
  bool turns = false;   // or slides
  bool swings = false;  // parallel bars: moves what follows along axis x bar without turning it
  Vector3 bar = Vector3::Zero();
  bool spring = false;  // or passive
};

Vector3 velocity(const Freedom& freedom, const Vector3& at) {
  if (freedom.turns) return freedom.axis.cross(at - freedom.point);
  return freedom.swings ? Vector3(freedom.axis.cross(freedom.bar)) : freedom.axis;
}

// A body of a leg: its weight acts at the pin on what moves the pin, and with its lever on what turns the body.
struct Weight {
  Vector3 pin, lever;
  double mass;
  int moved_by, turned_by;  // numbers of freedoms, from the base
};

// A leg, placed with its springs deflected.
struct Leg {
  int count = 0;
  std::array<Freedom, kMaxFreedoms> freedoms;
  Column value;  // deflections of springs, changes of passive joints
  // Springs: six freedoms of a beam from `first` on, or one of a drive.
  struct Spring {
    int first = 0;
    bool beam = false;
    double drive = 0.0;  // compliance of a drive
    Matrix6 compliance;  // of a beam
  };
  int spring_count = 0;
  std::array<Spring, 2 * kMaxLegJoints> springs;
  int weight_count = 0;
  std::array<Weight, 4 * kMaxLegJoints> weights;
  Vector3 tip;
  Matrix3 tip_rotation;

  // Of the last solution.
  Column deflection;
  Vector6 force;  // of the platform on the tip, about the tip
};

// Deflections of the springs under a load on each freedom; zero for passive joints.
template <class Load>
Column deflected(const Leg& leg, const Load& load) {
  Column result = Column::Zero(leg.count);
  for (int s = 0; s < leg.spring_count; ++s) {
    const Leg::Spring& spring = leg.springs[s];
    if (spring.beam) {
      const Vector6 own = load.template segment<6>(spring.first);
      result.segment<6>(spring.first).noalias() = spring.compliance * own;
    } else {
      result[spring.first] = spring.drive * load[spring.first];
    }
  }
  return result;
}

Matrix3 turn(const Vector3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

class LoadedMechanism {
 public:
  LoadedMechanism(const Posture& posture, const Loading& loading, const LoadedOptions& options)
      : posture_(posture),
        mechanism_(posture.mechanism()),
        loading_(loading),
        options_(options),
        tool_(posture.tool()),
        length_(mechanism_.characteristic_length()) {
    for (int l = 0; l < leg_count(); ++l) {
      count_freedoms(l);
      place(l);
    }
  }

  int leg_count() const { return static_cast<int>(mechanism_.legs().size()); }
  const Pose& tool() const { return tool_; }

  enum class Step { done, rigid, free };
  // One step towards balance; `size` becomes its size over the characteristic length.
  Step step(double& size);
  // About the present state.
  bool tangent(Matrix6& K);

 private:
  bool passive(const JointModel& joint) const {
    return joint.active < 0 || joint.free || options_.stiffness.drives == DriveState::free;
  }
  double drive_compliance(const JointModel& joint) const {
    if (joint.active < 0 || options_.stiffness.drive_stiffness.size() == 0) return 0.0;
    return 1.0 / options_.stiffness.drive_stiffness[joint.active];
  }
  const BeamModel* beam_of(int joint) const {
    for (const BeamModel& beam : mechanism_.beams()) {
      if (beam.joint == joint) return &beam;
    }
    return nullptr;
  }
  void count_freedoms(int l);
  void place(int l);
  int rows(int l) const { return internal::closure_rows(mechanism_.legs()[l]); }
  Vector3 arm(int l) const { return tool_.rotation * mechanism_.legs()[l].platform_point; }
  // Tip against platform, rotations times the length.
  Vector6 gap(int l) const;
  // Velocity of the tip per freedom, rotations times the length.
  void columns(const Leg& leg, Rows6& J) const;
  // B: velocity of the platform's end of the leg per displacement of the tool.
  Matrix6 platform(int l) const;
  // What weights do on each freedom.
  void weights_on(const Leg& leg, Column& g) const;
  Vector6 load() const;

  const Posture& posture_;
  const Mechanism& mechanism_;
  const Loading& loading_;
  const LoadedOptions& options_;
  std::array<Leg, kMaxLegs> legs_;
  Pose tool_;
  double length_;
  bool turning_ = false;  // some leg holds the platform's orientation
};

void LoadedMechanism::count_freedoms(int l) {
  const LegModel& model = mechanism_.legs()[l];
  turning_ = turning_ || model.attachment == Attachment::rigid;
  Leg& leg = legs_[l];
  leg.count = 0;
  for (int j = model.first; j < model.first + model.count; ++j) {
    const JointModel& joint = mechanism_.joints()[j];
    leg.count += passive(joint) || drive_compliance(joint) > 0.0 ? 1 : 0;
    leg.count += beam_of(j) != nullptr ? 6 : 0;
  }
  leg.value = Column::Zero(leg.count);
  leg.deflection = Column::Zero(leg.count);
  leg.force.setZero();
}

void LoadedMechanism::place(int l) {
  const LegModel& model = mechanism_.legs()[l];
  Leg& leg = legs_[l];
  Matrix3 R = Matrix3::Identity(), link = R;  // what carries the next axis, and the next point
  Vector3 p = Vector3::Zero();
  int next = 0;
  leg.weight_count = leg.spring_count = 0;
  std::array<int, kMaxLegJoints> moved_by, turned_by;
  std::array<Matrix3, kMaxLegJoints> rotation;
  std::array<Vector3, kMaxLegJoints> origin;
  for (int j = model.first; j < model.first + model.count; ++j) {
    const int k = j - model.first;
    const JointModel& joint = mechanism_.joints()[j];
    if (k == 0) p = joint.offset;
    double value = posture_.joints()[j];
    const Vector3 axis = R * joint.axis;
    const bool last = k + 1 == model.count;
    const Vector3& span = last ? model.tip : mechanism_.joints()[j + 1].offset;
    const double give = passive(joint) ? 0.0 : drive_compliance(joint);
    const bool gives = passive(joint) || give > 0.0;
    if (gives) value += leg.value[next];
    if (joint.type == JointType::revolute) R = R * turn(joint.axis, value);
    link = joint.type == JointType::parallelogram ? Matrix3(R * turn(joint.axis, value)) : R;
    if (gives) {
      leg.freedoms[next] = {.axis = axis,
                            .point = p,
                            .turns = joint.type == JointType::revolute,
                            .swings = joint.type == JointType::parallelogram,
                            .bar = link * span,
                            .spring = give > 0.0};
      if (give > 0.0) {
        Leg::Spring& spring = leg.springs[leg.spring_count++];
        spring.first = next;
        spring.beam = false;
        spring.drive = give;
      }
      ++next;
    }
    if (joint.type == JointType::prismatic) p += value * axis;
    moved_by[k] = turned_by[k] = next;
    rotation[k] = link;
    origin[k] = p;

    p += link * span;
    const BeamModel* beam = beam_of(j);
    if (beam == nullptr) continue;
    // The spring at the beam's end: shifts along its axes, then turns about them one after the other.
    Matrix3 F = link * beam->frame;
    for (int i = 0; i < 3; ++i) leg.freedoms[next + i] = {.axis = F.col(i), .point = p, .spring = true};
    p += F * leg.value.segment<3>(next);
    for (int i = 0; i < 3; ++i) {
      leg.freedoms[next + 3 + i] = {.axis = F.col(i), .point = p, .turns = true, .spring = true};
      F = F * turn(Vector3::Unit(i), leg.value[next + 3 + i]);
    }
    Leg::Spring& spring = leg.springs[leg.spring_count++];
    spring.first = next;
    spring.beam = true;
    spring.compliance = beam_compliance(beam->rigidity, beam->length);
    next += 6;
    R = link = F * beam->frame.transpose();
  }
  assert(next == leg.count);
  leg.tip = p;
  leg.tip_rotation = R * model.platform_rotation;

  for (const BodyModel& body : mechanism_.bodies()) {
    if (body.joint < model.first || body.joint >= model.first + model.count || body.mass == 0.0) continue;
    const int k = body.joint - model.first, t = body.turns_with - model.first;
    if (t < 0 || t >= model.count || leg.weight_count == static_cast<int>(leg.weights.size())) continue;
    leg.weights[leg.weight_count++] = {.pin = origin[k] + rotation[k] * body.pivot,
                                       .lever = rotation[t] * body.centre,
                                       .mass = body.mass,
                                       .moved_by = moved_by[k],
                                       .turned_by = turned_by[t]};
  }
}

Vector6 LoadedMechanism::gap(int l) const {
  const Leg& leg = legs_[l];
  Vector6 e = Vector6::Zero();
  e.head<3>() = leg.tip - tool_.position - arm(l);
  if (rows(l) == 6) e.tail<3>() = length_ * internal::rotation_between(tool_.rotation, leg.tip_rotation);
  return e;
}

void LoadedMechanism::columns(const Leg& leg, Rows6& J) const {
  J.resize(6, leg.count);
  for (int i = 0; i < leg.count; ++i) {
    J.col(i).head<3>() = velocity(leg.freedoms[i], leg.tip);
    J.col(i).tail<3>() = leg.freedoms[i].turns ? Vector3(length_ * leg.freedoms[i].axis) : Vector3::Zero();
  }
}

Matrix6 LoadedMechanism::platform(int l) const {
  Matrix6 B = Matrix6::Zero();
  B.topLeftCorner<3, 3>().setIdentity();
  if (!turning_) return B;
  B.topRightCorner<3, 3>() = -cross_matrix(arm(l)) / length_;  // rotations count times the length
  if (rows(l) == 6) B.bottomRightCorner<3, 3>().setIdentity();
  return B;
}

void LoadedMechanism::weights_on(const Leg& leg, Column& g) const {
  g = Column::Zero(leg.count);
  if (!loading_.weights) return;
  for (int w = 0; w < leg.weight_count; ++w) {
    const Weight& weight = leg.weights[w];
    const Vector3 force = weight.mass * mechanism_.gravity();
    for (int i = 0; i < weight.moved_by; ++i) g[i] += velocity(leg.freedoms[i], weight.pin).dot(force);
    for (int i = 0; i < weight.turned_by; ++i) {
      if (leg.freedoms[i].turns) g[i] += leg.freedoms[i].axis.dot(weight.lever.cross(force));
    }
  }
}

// On the platform, moments over the length.
Vector6 LoadedMechanism::load() const {
  Vector6 W = loading_.tool;
  if (loading_.weights) {
    for (const BodyModel& body : mechanism_.bodies()) {
      if (body.joint >= 0) continue;
      const Vector3 force = body.mass * mechanism_.gravity();
      W.head<3>() += force;
      W.tail<3>() += (tool_.rotation * body.centre).cross(force);
    }
  }
  W.tail<3>() /= length_;
  if (!turning_) W.tail<3>().setZero();
  return W;
}

LoadedMechanism::Step LoadedMechanism::step(double& size) {
  const int n = turning_ ? 6 : 3;
  // K dx = W - sum of B^T f_p + H^T D^-1 r, with the passive joints of every leg eliminated.
  Matrix6 K = Matrix6::Zero();
  Vector6 right = load();
  struct Solved {
    Elimination passive;
    Rows6 J;
    Matrix6 B;
    Vector6 e, f_p, r;  // r: of the wrenches, as many as there are
    Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 6, 6> H, N;
    Eigen::LLT<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>> D;
    Column g;
  };
  std::array<Solved, kMaxLegs> solved;
  for (int l = 0; l < leg_count(); ++l) {
    Leg& leg = legs_[l];
    Solved& s = solved[l];
    columns(leg, s.J);
    s.B = platform(l);
    s.e = gap(l);
    weights_on(leg, s.g);
    const int height = rows(l);
    int passive_count = 0;
    for (int i = 0; i < leg.count; ++i) passive_count += leg.freedoms[i].spring ? 0 : 1;
    s.passive.resize(height, passive_count);
    for (int i = 0, c = 0; i < leg.count; ++i) {
      if (leg.freedoms[i].spring) continue;
      for (int r = 0; r < height; ++r) s.passive.at(r, c) = s.J(r, i);
      ++c;
    }
    while (s.passive.step()) {
    }
    s.passive.finish();
    // f_p balances the weights on the passive joints.
    s.f_p.setZero();
    for (int i = 0, c = 0; i < leg.count; ++i) {
      if (leg.freedoms[i].spring) continue;
      for (int r = 0; r < height; ++r) s.f_p[r] -= s.passive.inverse(c)[r] * s.g[i];
      ++c;
    }
    const int wrenches = height - s.passive.rank();
    s.N.setZero(wrenches, 6);
    for (int w = 0; w < wrenches; ++w) {
      for (int r = 0; r < height; ++r) s.N(w, r) = s.passive.left_over(w)[r];
    }
    s.H = s.N * s.B;
    // Springs under f_p and the weights, less what they are deflected by already.
    const Column loads = s.J.transpose() * s.f_p + s.g;
    const Column springs = deflected(leg, loads);
    Column held = leg.value;
    for (int i = 0; i < leg.count; ++i) {
      if (!leg.freedoms[i].spring) held[i] = 0.0;
    }
    s.r.setZero();
    s.r.head(wrenches) = s.N * (s.e + s.J * (springs - held));
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6> D(wrenches, wrenches);
    std::array<Column, 6> loads_of;
    for (int w = 0; w < wrenches; ++w) {
      loads_of[w] = s.J.transpose() * s.N.row(w).transpose();
      const Column moved = deflected(leg, loads_of[w]);
      for (int v = 0; v <= w; ++v) D(w, v) = D(v, w) = loads_of[v].dot(moved);
    }
    s.D.compute(D);
    constexpr double kSingular = 1e-13;
    for (int w = 0; w < wrenches; ++w) {
      if (s.D.info() != Eigen::Success || !(std::pow(s.D.matrixLLT()(w, w), 2) > kSingular * D(w, w)))
        return Step::rigid;
    }
    K += s.H.transpose() * s.D.solve(s.H);
    right += s.H.transpose() * s.D.solve(s.r.head(wrenches)) - s.B.transpose() * s.f_p;
  }
  Vector6 dx = Vector6::Zero();
  {
    const ToolMatrix own = K.topLeftCorner(n, n);
    const Eigen::LDLT<ToolMatrix> factored(own);
    const double largest = factored.vectorD().maxCoeff();
    if (!(factored.vectorD().minCoeff() > 1e-13 * largest)) return Step::free;
    dx.head(n) = factored.solve(ToolVector(right.head(n)));
  }
  size = dx.norm();
  for (int l = 0; l < leg_count(); ++l) {
    Leg& leg = legs_[l];
    Solved& s = solved[l];
    const int wrenches = static_cast<int>(s.N.rows());
    leg.force = s.f_p + s.N.transpose() * s.D.solve(s.H * dx - s.r.head(wrenches));
    const Column loads = s.J.transpose() * leg.force + s.g;
    leg.deflection = deflected(leg, loads);
    Column change = leg.deflection - leg.value;
    for (int i = 0; i < leg.count; ++i) {
      if (!leg.freedoms[i].spring) change[i] = 0.0;
    }
    const Vector6 open = s.B * dx - s.e - s.J * change;
    for (int i = 0, c = 0; i < leg.count; ++i) {
      if (leg.freedoms[i].spring) continue;
      double rate = 0.0;
      for (int r = 0; r < rows(l); ++r) rate += s.passive.inverse(c)[r] * open[r];
      change[i] = rate;
      ++c;
    }
    leg.value += change;
    for (int i = 0; i < leg.count; ++i) {
      const double lever = leg.freedoms[i].turns || leg.freedoms[i].swings ? length_ : 1.0;
      size = std::max(size, std::abs(change[i]) * lever);
    }
  }
  size /= length_;
  tool_.position += dx.head<3>();
  tool_.rotation = internal::orthonormal(internal::turned_by(Vector3(dx.tail<3>() / length_), tool_.rotation));
  for (int l = 0; l < leg_count(); ++l) place(l);
  return Step::done;
}

// Takes d(J_i^T w)/dy_k from A, for a load of fixed direction, `force` at the point `at` and `moment` about it,
// that the first `count` freedoms move. They are numbered from the base outwards: one further out than i moves
// the point alone, u_i . (v_k x f); one further in turns the axis of i too, (u_k x v_i) . f + (u_k x u_i) . m.
void take_turning(const std::array<Freedom, kMaxFreedoms>& freedoms, int count, const Vector3& at,
                  const Vector3& force, const Vector3& moment, Square& A) {
  std::array<Vector3, kMaxFreedoms> v, g, h;  // velocity of the point, f x u and m x u of those that turn
  for (int i = 0; i < count; ++i) {
    const Freedom& one = freedoms[i];
    v[i] = velocity(one, at);
    g[i] = one.turns ? Vector3(force.cross(one.axis)) : Vector3(Vector3::Zero());
    h[i] = one.turns ? Vector3(moment.cross(one.axis)) : Vector3(Vector3::Zero());
  }
  for (int i = 0; i < count; ++i) {
    for (int k = i; k < count; ++k) A(i, k) -= g[i].dot(v[k]);
    for (int k = 0; k < i; ++k) {
      A(i, k) -= g[k].dot(v[i]);
      if (freedoms[i].turns) A(i, k) -= h[k].dot(freedoms[i].axis);
    }
  }
}

bool LoadedMechanism::tangent(Matrix6& K) {
  K.setZero();
  for (int l = 0; l < leg_count(); ++l) {
    const Leg& leg = legs_[l];
    const int m = leg.count, height = rows(l);
    Rows6 J;
    columns(leg, J);
    const Matrix6 B = platform(l);
    const Vector3 force = leg.force.head<3>(),
                  moment = height == 6 ? Vector3(length_ * leg.force.tail<3>()) : Vector3(Vector3::Zero());

    // In springs' own sizes, so that soft and stiff ones are alike: y = S y', equations times S.
    Column scale = Column::Ones(m);
    Square A = Square::Zero(m + height, m + height);
    for (int k = 0; k < leg.spring_count; ++k) {
      const Leg::Spring& spring = leg.springs[k];
      if (spring.beam) {
        scale.segment<6>(spring.first) = spring.compliance.diagonal().cwiseSqrt();
        A.block<6, 6>(spring.first, spring.first) = spring.compliance.inverse();
      } else {
        scale[spring.first] = std::sqrt(spring.drive);
        A(spring.first, spring.first) = 1.0 / spring.drive;
      }
    }
    double size = 0.0;
    for (int i = 0; i < m; ++i) {
      if (leg.freedoms[i].spring) size = std::max(size, J.col(i).norm() * scale[i]);
    }
    if (!(size > 0.0)) return false;
    for (int i = 0; i < m; ++i) {
      if (!leg.freedoms[i].spring) scale[i] = size / std::max(J.col(i).norm(), 1e-12 * length_);
    }

    take_turning(leg.freedoms, m, leg.tip, force, moment, A);
    for (int w = 0; loading_.weights && w < leg.weight_count; ++w) {
      const Weight& weight = leg.weights[w];
      const Vector3 pull = weight.mass * mechanism_.gravity();
      take_turning(leg.freedoms, weight.moved_by, weight.pin, pull, Vector3::Zero(), A);
      // The lever turns with all that turn the body.
      for (int i = 0; i < weight.turned_by; ++i) {
        if (!leg.freedoms[i].turns) continue;
        for (int k = 0; k < weight.turned_by; ++k) {
          if (!leg.freedoms[k].turns) continue;
          const Vector3 &u = leg.freedoms[i].axis, &v = leg.freedoms[k].axis;
          A(i, k) -=
              k < i ? v.cross(u.cross(weight.lever)).dot(pull) : u.cross(v.cross(weight.lever)).dot(pull);
        }
      }
    }
    A.topRightCorner(m, height) = -J.topRows(height).transpose();
    A.bottomLeftCorner(height, m) = J.topRows(height);
    for (int i = 0; i < m; ++i) {
      A.row(i) *= scale[i];
      A.col(i) *= scale[i];
    }
    A.rightCols(height) /= size;
    A.bottomRows(height) /= size;
    Eigen::Matrix<double, Eigen::Dynamic, 6, 0, kMaxFreedoms + 6, 6> moved;
    moved.setZero(m + height, 6);
    moved.bottomRows(height) = B.topRows(height) / size;
    const Eigen::PartialPivLU<Square> factored(A);
    const Eigen::Matrix<double, Eigen::Dynamic, 6, 0, kMaxFreedoms + 6, 6> answer = factored.solve(moved);
    Matrix6 forces = Matrix6::Zero();
    forces.topRows(height) = answer.bottomRows(height) / size;
    if (!forces.allFinite()) return false;
    K += B.transpose() * forces;
    // The lever from the tool to the leg's end turns with the platform.
    if (turning_)
      K.bottomRightCorner<3, 3>() += cross_matrix(force) * cross_matrix(arm(l)) / (length_ * length_);
  }
  if (turning_ && loading_.weights) {
    for (const BodyModel& body : mechanism_.bodies()) {
      if (body.joint >= 0) continue;
      const Vector3 pull = body.mass * mechanism_.gravity(), centre = tool_.rotation * body.centre;
      K.bottomRightCorner<3, 3>() -= cross_matrix(pull) * cross_matrix(centre) / (length_ * length_);
    }
  }
  // Rotations in radians again.
  K.bottomRows<3>() *= length_;
  K.rightCols<3>() *= length_;
  return true;
}

}  // namespace

const char* to_string(LoadedStatus status) noexcept {
  switch (status) {
    case LoadedStatus::balanced:
      return "balanced";
    case LoadedStatus::not_converged:
      return "not converged";
    case LoadedStatus::unstable:
      return "unstable";
    case LoadedStatus::rigid:
      return "rigid";
    case LoadedStatus::free:
      return "free";
  }
  return "";
}

LoadedState loaded_stiffness(const Posture& posture, const Loading& loading,
                             const LoadedOptions& options) noexcept {
  LoadedState state;
  LoadedMechanism loaded(posture, loading, options);
  state.status = LoadedStatus::not_converged;
  const int most = options.method == LoadedMethod::direct ? 1 : options.max_iterations;
  constexpr double kOutOfHand = 1.0;  // steps as long as the mechanism
  while (state.iterations < most) {
    const LoadedMechanism::Step step = loaded.step(state.residual);
    if (step == LoadedMechanism::Step::rigid) state.status = LoadedStatus::rigid;
    if (step == LoadedMechanism::Step::free) state.status = LoadedStatus::free;
    if (step != LoadedMechanism::Step::done) return state;
    ++state.iterations;
    if (!(state.residual < kOutOfHand)) {
      state.status = LoadedStatus::unstable;
      return state;
    }
    if (state.residual <= options.tolerance || options.method == LoadedMethod::direct) {
      state.status = LoadedStatus::balanced;
      break;
    }
  }
  state.tool = loaded.tool();
  state.displacement << state.tool.position - posture.tool().position,
      internal::rotation_between(posture.tool().rotation, state.tool.rotation);
  if (state.status == LoadedStatus::balanced && !loaded.tangent(state.stiffness))
    state.status = LoadedStatus::free;
  return state;
}

}  // namespace zwidth

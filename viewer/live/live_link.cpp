#include "viewer/live/live_link.hpp"

#include "common/base/child_process.hpp"
#include "common/base/error.hpp"
#include "common/base/program.hpp"
#include "common/base/scratch_folder.hpp"
#include "common/base/text.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr auto answer_poll = 1ms;
/// Longest wait for the greeting. Before it answers, the live solver loads its libraries and
/// analyses the sparsity pattern of the body.
constexpr auto greeting_patience = 30s;
constexpr auto connection_patience = 5s;
/// Longest wait for an answer. A solve that begins from rest takes longer than any other.
constexpr auto answer_patience = 3s;
/// The user is warned if this many hand positions in a row have no equilibrium.
constexpr int most_unsolved = 3;
/// The user is warned if an answer takes longer than this.
constexpr auto late_after = 300ms;
/// Shortest time between the beginnings of two connections.
constexpr auto shortest_connection = 500ms;
/// The speed of a hand is its motion over at least this time, s.
constexpr double speed_time = 0.004;

std::string refusalIn(const wire::Message& reply) {
  return fmt::format("the live solver refused: {}",
                     printable(reply.refused().reason(), longest_reason));
}

/// Describes why an answer has no equilibrium.
std::string whyUnsolved(const wire::Followed& answer, const std::optional<Followed>& read) {
  if (!answer.objection().empty()) return printable(answer.objection(), longest_reason);
  return read ? describe(read->failure()) : "its answer cannot be read";
}

}  // namespace

/// A live solver as a child process. Its socket lies in a directory that only this user can open.
struct LiveLink::Follower {
  explicit Follower(const std::string& worker)
      : process({worker.empty() ? programBeside("palpate-worker").string() : worker, "follow",
                 "--quiet", "--insecure", "--listen", endpoint()}) {}

  std::string endpoint() const { return "ipc://" + (folder / "follower").string(); }

  ScratchFolder folder;
  ChildProcess process;  ///< is killed at the end: it has nothing to save
};

LiveLink::LiveLink(LiveTouch& touch, LiveLinkOptions options)
    : touch_(touch), options_(std::move(options)) {
  if (!options_.endpoint.empty()) checkEndpoint(options_.endpoint);
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

LiveLink::~LiveLink() = default;

bool LiveLink::waitUntilReady(std::chrono::seconds longest) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, longest, [&] { return ready_ || !trouble_.empty(); });
  return ready_;
}

std::string LiveLink::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

LiveStatistics LiveLink::statistics() const {
  const std::lock_guard lock(mutex_);
  return statistics_;
}

void LiveLink::tell(std::string trouble) {
  const std::lock_guard lock(mutex_);
  ready_ = trouble.empty();
  if (trouble == trouble_ && !ready_) return;
  trouble_ = std::move(trouble);
  changed_.notify_all();
}

void LiveLink::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const auto began = Clock::now();
    try {
      attend(stop);
      sayGoodbye();
    } catch (const std::exception& error) {
      tell(error.what());
    }
    if (stop.stop_requested()) break;
    {
      const std::lock_guard lock(mutex_);
      ++statistics_.restarts;
    }
    std::this_thread::sleep_until(began + shortest_connection);
  }
  follower_.reset();
}

/// Keeps one connection. Returns when the connection fails or `stop` is requested.
void LiveLink::attend(const std::stop_token& stop) {
  if (std::string trouble = connect(); !trouble.empty()) return tell(std::move(trouble));
  if (!greet(stop)) return;
  tell({});
  before_ = {};
  unsolved_ = 0;
  while (!stop.stop_requested()) {
    const LiveHand hand = touch_.hand();
    if (hand.time == before_.time || (!hand.touching && !before_.touching)) {
      std::this_thread::sleep_for(answer_poll);
      if (ended()) return tell(whyNoAnswer());
      continue;
    }
    if (!askAbout(hand, stop)) return;
  }
}

std::string LiveLink::connect() {
  socket_ = makeDealer(context_);
  if (options_.endpoint.empty()) {
    follower_.reset();
    follower_ = std::make_unique<Follower>(options_.worker);
    // It listens in a moment.
    socket_.set(zmq::sockopt::reconnect_ivl, 10);
    socket_.set(zmq::sockopt::reconnect_ivl_max, 0);
    return connectDealer(socket_, follower_->endpoint());
  }
  if (options_.keys) proveAsClient(socket_, *options_.keys, options_.endpoint);
  handshakes_.emplace(context_, socket_);
  return connectDealer(socket_, options_.endpoint);
}

bool LiveLink::greet(const std::stop_token& stop) {
  wire::Message greeting;
  wire::FollowRequest& request = *greeting.mutable_follow_request();
  request.set_protocol(protocol_version);
  request.set_finger_radius(touch_.fingerRadius());
  request.set_payload_bytes(static_cast<std::uint32_t>(options_.problem.size()));
  const auto reply = ask(greeting, options_.problem, greeting_patience, stop);
  if (reply && reply->has_follow_reply()) return true;
  if (stop.stop_requested()) return false;
  tell(reply && reply->has_refused() ? refusalIn(*reply) : whyNoAnswer());
  return false;
}

/// Sends the state of the hand, and passes the equilibrium near the hand to the haptic loop.
/// Returns false if the connection has failed or `stop` is requested.
bool LiveLink::askAbout(const LiveHand& hand, const std::stop_token& stop) {
  const bool follows = before_.touching && hand.time > before_.time;
  if (hand.touching && follows && hand.time - before_.time < speed_time) {
    std::this_thread::sleep_for(answer_poll);
    return true;
  }
  wire::Message question;
  wire::HandMotion& message = *question.mutable_hand_motion();
  if (hand.touching) {
    HandMotion motion = {.place = hand.place, .displacement = hand.displacement, .hold = hand.hold};
    if (follows) {
      const double time = hand.time - before_.time;
      motion.place_speed = (hand.place - before_.place) / time;
      motion.displacement_speed = (hand.displacement - before_.displacement) / time;
    }
    toWire(motion, message);
  } else {
    message.set_released(true);
  }
  before_ = hand;
  const auto asked = Clock::now();
  const auto reply = ask(question, {}, answer_patience, stop);
  if (stop.stop_requested()) return false;
  if (!reply || reply->has_refused()) {
    tell(reply ? refusalIn(*reply) : whyNoAnswer());
    return false;
  }
  const auto followed = fromWire(reply->followed());
  const bool found = followed && followed->converged();
  if (found) touch_.answer(followed->expansion());
  unsolved_ = found || !reply->has_followed() ? 0 : unsolved_ + 1;
  if (unsolved_ < most_unsolved)
    tell({});
  else if (unsolved_ == most_unsolved)
    tell(fmt::format("the live solver finds no equilibrium {}: {}",
                     hand.hold ? "of the hand and the second finger" : "near the hand",
                     whyUnsolved(reply->followed(), followed)));
  if (!reply->has_followed()) return true;
  const std::chrono::duration<double> took = Clock::now() - asked;
  const std::lock_guard lock(mutex_);
  ++(found ? statistics_.answers : statistics_.failures);
  statistics_.seconds += took.count();
  statistics_.largest_seconds = std::max(statistics_.largest_seconds, took.count());
  return true;
}

/// Frees the place at a live solver elsewhere. Does not wait for it.
void LiveLink::sayGoodbye() {
  if (follower_) return;
  wire::Message farewell;
  farewell.mutable_goodbye();
  socket_.set(zmq::sockopt::linger, 500);  // ms: the message is on its way when the program ends
  static_cast<void>(sendMessage(socket_, "", farewell));
}

bool LiveLink::ended() const { return follower_ && !follower_->process.running(); }

std::string LiveLink::whyNoAnswer() const {
  if (ended()) return fmt::format("the live solver has ended: {}", follower_->process.how());
  if (follower_) return "the live solver does not answer";
  if (!key_trouble_.empty())
    return fmt::format("live solver at {}: {}", options_.endpoint, key_trouble_);
  return fmt::format("no live solver answers at {}: start one there with palpate follow --listen",
                     options_.endpoint);
}

/// Returns the answer of the live solver; nullopt if it does not arrive in time, if the process
/// has ended, or if one side does not accept the key of the other.
std::optional<wire::Message> LiveLink::ask(const wire::Message& question, std::string_view payload,
                                           std::chrono::milliseconds patience,
                                           const std::stop_token& stop) {
  const auto until = Clock::now() + patience;
  const auto goes_on = [&] {
    key_trouble_ = handshakes_ ? handshakes_->trouble() : "";
    return key_trouble_.empty() && Clock::now() < until && !stop.stop_requested() && !ended();
  };
  // The socket accepts no message until the connection is established.
  const auto began = Clock::now();
  while (sendMessage(socket_, "", question, payload) != Sent::yes) {
    if (!goes_on() || Clock::now() - began > connection_patience) return std::nullopt;
    std::this_thread::sleep_for(answer_poll);
  }
  while (goes_on()) {
    waitForMessages(socket_, 20ms);
    if (auto incoming = receiveMessage(socket_, false)) return std::move(incoming->message);
    if (question.has_hand_motion() && unsolved_ < most_unsolved &&
        Clock::now() - began > late_after)
      tell(
          "live solving is late: the solver needs longer than the hand or the second finger allows");
  }
  return std::nullopt;
}

}  // namespace palpate

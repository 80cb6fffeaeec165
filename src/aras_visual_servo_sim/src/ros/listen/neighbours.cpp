#include "neighbours.hpp"

#include <netdb.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cerrno>
#include <memory>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr time_t kConnectS = 2;  // wall

/** True if a process listens at the address, or if it does not say within kConnectS that none does. */
bool listens(const std::string& host, std::uint32_t port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  if (getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &list) != 0) return false;
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> addresses(list, freeaddrinfo);
  for (const addrinfo* one = list; one != nullptr; one = one->ai_next) {
    const int link = socket(one->ai_family, one->ai_socktype, one->ai_protocol);
    if (link < 0) continue;
    const timeval limit{kConnectS, 0};
    setsockopt(link, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
    const bool answers = connect(link, one->ai_addr, one->ai_addrlen) == 0 || errno == EINPROGRESS;
    close(link);
    if (answers) return true;
  }
  return false;
}

/** URI of a node that runs, empty if the master knows none: one that was killed is known until its name is reused. */
std::string uriOfRunning(const std::string& node) {
  XmlRpc::XmlRpcValue request, response, uri;
  request[0] = ros::this_node::getName();
  request[1] = node;
  std::string host;
  std::uint32_t port = 0;
  if (!ros::master::execute("lookupNode", request, response, uri, true)) return "";
  if (!ros::network::splitURI(static_cast<std::string>(uri), host, port) || !listens(host, port)) return "";
  return static_cast<std::string>(uri);
}

}  // namespace

std::vector<std::string> publishersOf(const std::string& topic) {
  XmlRpc::XmlRpcValue request, response, state;
  request[0] = ros::this_node::getName();
  std::vector<std::string> names;
  if (!ros::master::execute("getSystemState", request, response, state, false)) return names;
  XmlRpc::XmlRpcValue& publishers = state[0];
  for (int k = 0; k < publishers.size(); ++k) {
    if (static_cast<std::string>(publishers[k][0]) != topic) continue;
    for (int j = 0; j < publishers[k][1].size(); ++j) names.push_back(static_cast<std::string>(publishers[k][1][j]));
  }
  return names;
}

void requireOwnName() {
  const std::string name = ros::this_node::getName();
  const std::string uri = uriOfRunning(name);
  if (uri.empty()) return;
  throw ArasError("node '" + name + "': runs already, at " + uri + "; end that one, or start this one in a namespace " +
                  "of its own (sim.launch: ns:=NAME clock:=/NAME/clock)");
}

void requireOwnClock(const std::string& topic) {
  for (const std::string& node : publishersOf(topic)) {
    if (node == ros::this_node::getName()) return;
    if (uriOfRunning(node).empty()) continue;
    throw ArasError(topic + ": node '" + node + "' publishes it already, allowed is one; give this simulator a clock " +
                    "of its own (sim.launch: clock:=/NAME/clock)");
  }
}

}  // namespace aras_visual_servo_sim

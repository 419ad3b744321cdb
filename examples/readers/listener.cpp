// Prints the touchdowns that the predictor announces: listener [topic]
//
// On rcl alone, below rclcpp, so that it builds where only that is. In a node of rclcpp `said` is the same, in
// create_subscription<impact_predictor_msgs::msg::Prediction>(topic, 10, ...).

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <impact_predictor_msgs/msg/prediction.hpp>
#include <rcl/error_handling.h>
#include <rcl/rcl.h>
#include <rosidl_typesupport_cpp/message_type_support.hpp>

using impact_predictor_msgs::msg::Contact;
using impact_predictor_msgs::msg::Prediction;

/// What a controller would do with a prediction.
std::string said(const Prediction & told)
{
  if (told.mode == Prediction::MODE_NO_IMPACT) {
    return "";
  }
  char line[256];
  const auto & after = told.after.linear;
  std::snprintf(
    line, sizeof line, "%s %d.%09u %.6f s ahead, mode %d, after %.4f %.4f %.4f m/s, flags %u", told.body.c_str(),
    told.header.stamp.sec, told.header.stamp.nanosec, told.lead_time, told.mode, after.x, after.y, after.z, told.flags);
  std::string text = line;
  for (const auto & contact : told.contacts) {
    std::snprintf(
      line, sizeof line, "; point %u %s, %.4f N s at %.4f %.4f %.4f", contact.point,
      contact.state == Contact::STATE_LEAVES ? "leaves" : "stays",
      std::hypot(contact.impulse.x, contact.impulse.y, contact.impulse.z),
      contact.position.x, contact.position.y, contact.position.z);
    text += line;
  }
  for (const auto & foot : told.feet) {
    std::snprintf(line, sizeof line, "; %s %s", foot.name.c_str(), foot.stands ? "stands" : "swings");
    text += line;
  }
  return text;
}

/// Ends the program with the reason where a call fails.
void check(rcl_ret_t status)
{
  if (status != RCL_RET_OK) {
    std::fprintf(stderr, "listener: %s\n", rcl_get_error_string().str);
    std::exit(1);
  }
}

int main(int argc, char ** argv)
{
  const auto allocator = rcl_get_default_allocator();
  auto options = rcl_get_zero_initialized_init_options();
  check(rcl_init_options_init(&options, allocator));
  auto context = rcl_get_zero_initialized_context();
  check(rcl_init(0, nullptr, &options, &context));
  auto node = rcl_get_zero_initialized_node();
  const auto node_options = rcl_node_get_default_options();
  check(rcl_node_init(&node, "listener", "", &context, &node_options));
  auto subscription = rcl_get_zero_initialized_subscription();
  auto subscription_options = rcl_subscription_get_default_options();
  subscription_options.qos.depth = 1000;
  const auto type = rosidl_typesupport_cpp::get_message_type_support_handle<Prediction>();
  const char * topic = argc > 1 ? argv[1] : "/impact_predictor/prediction";
  check(rcl_subscription_init(&subscription, &node, type, topic, &subscription_options));
  auto waiting = rcl_get_zero_initialized_wait_set();
  check(rcl_wait_set_init(&waiting, 1, 0, 0, 0, 0, 0, &context, allocator));
  while (true) {
    check(rcl_wait_set_clear(&waiting));
    check(rcl_wait_set_add_subscription(&waiting, &subscription, nullptr));
    check(rcl_wait(&waiting, -1));
    Prediction told;
    while (rcl_take(&subscription, &told, nullptr, nullptr) == RCL_RET_OK) {
      const auto text = said(told);
      if (!text.empty()) {
        std::puts(text.c_str());
        std::fflush(stdout);
      }
    }
    rcl_reset_error();
  }
}

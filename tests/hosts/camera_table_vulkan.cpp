// SPDX-License-Identifier: Apache-2.0
// Runs petzval_camera.h as a Vulkan shader on a processor (lavapipe) or a GPU, and compares the rays with
// the same file compiled as C++.
//
//   petzval export LENS --camera camera.bin
//   glslc -std=450 -fshader-stage=compute -O -I include/petzval tests/hosts/camera_table.comp -o camera.spv
//   camera_table_vulkan camera.spv camera.bin [WAVELENGTH...]
#include <vulkan/vulkan.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "petzval/petzval_camera.h"

namespace {

constexpr std::uint32_t count = 1 << 16, numbers_in = 5, numbers_out = 12;

void check(VkResult result, const char* what) {
  if (result != VK_SUCCESS) throw std::runtime_error(std::string(what) + " returns " + std::to_string(result));
}

template <class T>
std::vector<T> read(const char* file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  if (bytes.size() < sizeof(T)) throw std::runtime_error(std::string(file) + " is empty or missing");
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

/// A device, and buffers that the processor can write and read.
class Device {
 public:
  Device() {
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_1};
    const VkInstanceCreateInfo create{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                      .pApplicationInfo = &application};
    check(vkCreateInstance(&create, nullptr, &instance_), "vkCreateInstance");
    std::uint32_t devices = 1;
    const VkResult found = vkEnumeratePhysicalDevices(instance_, &devices, &physical_);
    if ((found != VK_SUCCESS && found != VK_INCOMPLETE) || devices == 0) throw std::runtime_error("no Vulkan device");
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical_, &properties);
    name = properties.deviceName;
    const float priority = 1;  // the first family of queues of all known devices can compute
    const VkDeviceQueueCreateInfo queue{
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1, .pQueuePriorities = &priority};
    const VkDeviceCreateInfo device{
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue};
    check(vkCreateDevice(physical_, &device, nullptr, &device_), "vkCreateDevice");
    vkGetDeviceQueue(device_, 0, 0, &queue_);
  }

  /// Runs a shader over the buffers, and returns the last buffer. Sets `seconds`.
  std::vector<float> run(const std::vector<std::uint32_t>& code, std::array<std::vector<float>, 3> values) {
    std::array<VkBuffer, 3> buffers;
    std::array<float*, 3> mapped;
    for (std::size_t k = 0; k < 3; ++k) {
      mapped[k] = buffer(4 * values[k].size(), buffers[k]);
      std::ranges::copy(values[k], mapped[k]);
    }
    const VkShaderModuleCreateInfo shader{
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = 4 * code.size(), .pCode = code.data()};
    VkShaderModule module;
    check(vkCreateShaderModule(device_, &shader, nullptr, &module), "vkCreateShaderModule");
    std::array<VkDescriptorSetLayoutBinding, 3> bindings;
    for (std::uint32_t k = 0; k < 3; ++k) {
      bindings[k] = {k, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
    }
    const VkDescriptorSetLayoutCreateInfo set_info{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = 3, .pBindings = bindings.data()};
    VkDescriptorSetLayout set_layout;
    check(vkCreateDescriptorSetLayout(device_, &set_info, nullptr, &set_layout), "vkCreateDescriptorSetLayout");
    const VkPipelineLayoutCreateInfo layout_info{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, .setLayoutCount = 1, .pSetLayouts = &set_layout};
    VkPipelineLayout layout;
    check(vkCreatePipelineLayout(device_, &layout_info, nullptr, &layout), "vkCreatePipelineLayout");
    const VkComputePipelineCreateInfo pipeline_info{
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main"},
        .layout = layout};
    VkPipeline pipeline;
    check(vkCreateComputePipelines(device_, {}, 1, &pipeline_info, nullptr, &pipeline), "vkCreateComputePipelines");

    const VkDescriptorPoolSize pool_size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 3};
    const VkDescriptorPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                               .maxSets = 1,
                                               .poolSizeCount = 1,
                                               .pPoolSizes = &pool_size};
    VkDescriptorPool pool;
    check(vkCreateDescriptorPool(device_, &pool_info, nullptr, &pool), "vkCreateDescriptorPool");
    const VkDescriptorSetAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                               .descriptorPool = pool,
                                               .descriptorSetCount = 1,
                                               .pSetLayouts = &set_layout};
    VkDescriptorSet set;
    check(vkAllocateDescriptorSets(device_, &allocate, &set), "vkAllocateDescriptorSets");
    for (std::uint32_t k = 0; k < 3; ++k) {
      const VkDescriptorBufferInfo whole{buffers[k], 0, VK_WHOLE_SIZE};
      const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                       .dstSet = set,
                                       .dstBinding = k,
                                       .descriptorCount = 1,
                                       .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                       .pBufferInfo = &whole};
      vkUpdateDescriptorSets(device_, 1, &write, 0, nullptr);
    }
    const VkCommandPoolCreateInfo commands_info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    VkCommandPool command_pool;
    check(vkCreateCommandPool(device_, &commands_info, nullptr, &command_pool), "vkCreateCommandPool");
    const VkCommandBufferAllocateInfo command_info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                   .commandPool = command_pool,
                                                   .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                   .commandBufferCount = 1};
    VkCommandBuffer commands;
    check(vkAllocateCommandBuffers(device_, &command_info, &commands), "vkAllocateCommandBuffers");
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    check(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, 1, &set, 0, nullptr);
    vkCmdDispatch(commands, count / 64, 1, 1);
    check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    const VkSubmitInfo submit{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &commands};
    const auto start = std::chrono::steady_clock::now();
    check(vkQueueSubmit(queue_, 1, &submit, {}), "vkQueueSubmit");
    check(vkQueueWaitIdle(queue_), "vkQueueWaitIdle");
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return {mapped[2], mapped[2] + values[2].size()};
  }

  std::string name;
  double seconds = 0;

 private:
  float* buffer(VkDeviceSize bytes, VkBuffer& made) const {
    const VkBufferCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
    check(vkCreateBuffer(device_, &create, nullptr, &made), "vkCreateBuffer");
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device_, made, &needs);
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory);
    constexpr VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    std::uint32_t type = 0;
    while (type < memory.memoryTypeCount &&
           !((needs.memoryTypeBits >> type & 1) != 0 && (memory.memoryTypes[type].propertyFlags & wanted) == wanted)) {
      ++type;
    }
    const VkMemoryAllocateInfo allocate{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size, .memoryTypeIndex = type};
    VkDeviceMemory allocated;
    check(vkAllocateMemory(device_, &allocate, nullptr, &allocated), "vkAllocateMemory");
    check(vkBindBufferMemory(device_, made, allocated, 0), "vkBindBufferMemory");
    void* mapped = nullptr;
    check(vkMapMemory(device_, allocated, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
    return static_cast<float*>(mapped);
  }

  VkInstance instance_{};
  VkPhysicalDevice physical_{};
  VkDevice device_{};
  VkQueue queue_{};
};

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc < 3) throw std::runtime_error("must be called as: camera_table_vulkan SHADER.spv TABLE.bin [NM...]");
    const std::vector<float> table = read<float>(argv[2]);
    const float* const t = table.data();
    std::vector<float> wavelengths;
    for (int k = 3; k < argc; ++k) wavelengths.push_back(std::strtof(argv[k], nullptr));
    if (wavelengths.empty()) wavelengths = {table[static_cast<std::size_t>(table[PZ_WAVELENGTHS])]};
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit;
    std::vector<float> given(numbers_in * count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const pz_point film = pz_film_point(t, unit(random) * table[PZ_COLUMNS], unit(random) * table[PZ_ROWS]);
      float* const own = given.data() + numbers_in * i;
      own[0] = film.x, own[1] = film.y, own[2] = unit(random), own[3] = unit(random);
      own[4] = wavelengths[i % wavelengths.size()];
    }
    Device device;
    const std::vector<float> found =
        device.run(read<std::uint32_t>(argv[1]), {table, given, std::vector<float>(numbers_out * count)});
    const auto start = std::chrono::steady_clock::now();
    double ray_error = 0, film_error = 0, weight_error = 0;
    std::uint32_t lit = 0, connected = 0, other_fates = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const float *const in = given.data() + numbers_in * i, *const out = found.data() + numbers_out * i;
      const pz_ray ray = pz_sample(t, in[0], in[1], in[2], in[3], in[4]);
      const pz_connection c = pz_connect(t, pz_along(ray.origin, 500, ray.direction), in[2], in[3], in[4]);
      other_fates += (out[7] == 0) != (ray.fate == 0);
      if (ray.fate != 0 || out[7] != 0) continue;
      ++lit;
      const std::array wanted{ray.origin.x,    ray.origin.y,    ray.origin.z,
                              ray.direction.x, ray.direction.y, ray.direction.z};
      for (std::size_t k = 0; k < 6; ++k) {
        ray_error = std::max(ray_error, std::abs(double{wanted[k]} - out[k]) / (k < 3 ? 100 : 1));
      }
      weight_error = std::max(weight_error, std::abs(double{out[6]} / ray.weight - 1));
      other_fates += (out[11] == 0) != (c.arrival.fate == 0);
      if (c.arrival.fate != 0 || out[11] != 0) continue;
      ++connected;
      film_error =
          std::max(film_error, std::hypot(double{c.arrival.film.x} - out[8], double{c.arrival.film.y} - out[9]) /
                                   table[PZ_FILM_WIDTH]);
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf(
        "%s: %u rays, %u connections; rays differ by %.1e (radians, 100 mm), weights by %.1e, film points by "
        "%.1e of the width; %u other fates\n",
        device.name.c_str(), lit, connected, ray_error, weight_error, film_error, other_fates);
    std::printf("a ray and a connection: %.2f million per second; on one core as C++: %.2f\n",
                1e-6 * count / device.seconds, 1e-6 * count / seconds);
    const bool good = lit > count / 2 && connected > lit / 4 && ray_error < 5e-6 && weight_error < 1e-4 &&
                      film_error < 2e-5 && other_fates < 20;
    return good ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}

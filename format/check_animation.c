// check_animation.c - SPEC R4.19 to R4.21: animations, their channels and keys.

#include "check.h"

// What the pass over all channels carries along: how much of KEYS is taken.
typedef struct KeyPass
{
    const LsChannel* before; // NULL for the first
    uint64_t next_key;
    uint32_t key_count;
} KeyPass;

static uint32_t count_numbers(const LsChannel* channel)
{
    const uint32_t size = channel->path == LS_PATH_ROTATION ? 4 : 3;
    return channel->interpolation == LS_INTERPOLATION_CUBIC ? 3 * size : size;
}

// R4.20 for channel `index`, the `place`th of its animation, without its keys.
static LsResult check_channel(const LsCheck* check, const KeyPass* pass, uint32_t index,
                              uint32_t place)
{
    const LsChannel* channel = &check->file->channels[index];
    const uint32_t node_count = count_records(check, LS_CHUNK_NODES);
    // Three channels of a node in a row; each three of a later node than the one before.
    const bool in_order = place == 0       ? true
                          : place % 3 == 0 ? channel->node > pass->before->node
                                           : channel->node == pass->before->node;
    if (channel->node >= node_count || !in_order || channel->path != place % 3)
    {
        return ls_check_report(check, "R4.20", LS_CHUNK_CHANNELS, index,
                               "path %u of node %u of %u at place %u of its animation",
                               channel->path, channel->node, node_count, place);
    }
    if (channel->interpolation > LS_INTERPOLATION_CUBIC || channel->key_count < 1 ||
        !is_zero(channel->reserved, sizeof(channel->reserved)))
    {
        return ls_check_report(check, "R4.20", LS_CHUNK_CHANNELS, index,
                               "interpolation %u, %u keys, or a reserved word",
                               channel->interpolation, channel->key_count);
    }
    return LS_OK;
}

// Takes the channel's part of KEYS; *shares tells that its times are those of the channel before.
static LsResult take_keys(const LsCheck* check, KeyPass* pass, uint32_t index, bool* shares)
{
    const LsChannel* channel = &check->file->channels[index];
    *shares = pass->before != NULL && channel->first_time == pass->before->first_time &&
              channel->key_count == pass->before->key_count;
    const uint64_t time_end = pass->next_key + (*shares ? 0 : channel->key_count);
    const uint64_t end = time_end + (uint64_t)channel->key_count * count_numbers(channel);
    if ((!*shares && channel->first_time != pass->next_key) || channel->first_value != time_end ||
        end > pass->key_count)
    {
        return ls_check_report(check, "R4.20", LS_CHUNK_CHANNELS, index,
                               "%u keys, times from %u, values from %u; the next is %llu of %u",
                               channel->key_count, channel->first_time, channel->first_value,
                               (unsigned long long)pass->next_key, pass->key_count);
    }
    pass->next_key = end;
    return LS_OK;
}

static LsResult check_times(const LsCheck* check, const LsChannel* channel)
{
    const float* times = check->file->keys + channel->first_time;
    for (uint32_t i = 0; i < channel->key_count; ++i)
    {
        if (!(isfinite(times[i]) && times[i] >= 0 && (i == 0 || times[i] > times[i - 1])))
        {
            return ls_check_report(check, "R4.21", LS_CHUNK_KEYS, (uint64_t)channel->first_time + i,
                                   "time %g after %g", (double)times[i],
                                   i == 0 ? 0 : (double)times[i - 1]);
        }
    }
    return LS_OK;
}

static LsResult check_values(const LsCheck* check, const LsChannel* channel)
{
    const float* values = check->file->keys + channel->first_value;
    const uint64_t count = (uint64_t)channel->key_count * count_numbers(channel);
    for (uint64_t i = 0; i < count; ++i)
    {
        if (!isfinite(values[i]))
        {
            return ls_check_report(check, "R4.21", LS_CHUNK_KEYS, channel->first_value + i,
                                   "value %g", (double)values[i]);
        }
    }
    if (channel->path != LS_PATH_ROTATION)
    {
        return LS_OK;
    }
    const bool cubic = channel->interpolation == LS_INTERPOLATION_CUBIC;
    for (uint64_t i = cubic ? 4 : 0; i < count; i += cubic ? 12 : 4)
    {
        double squared = 0;
        for (int k = 0; k < 4; ++k)
        {
            squared += (double)values[i + k] * values[i + k];
        }
        if (!is_unit(squared))
        {
            return ls_check_report(check, "R4.21", LS_CHUNK_KEYS, channel->first_value + i,
                                   "a rotation of squared length %g", squared);
        }
    }
    return LS_OK;
}

// Channel `index`, the `place`th of its animation; *duration grows to its greatest time.
static LsResult check_motion(const LsCheck* check, KeyPass* pass, uint32_t index, uint32_t place,
                             float* duration)
{
    const LsChannel* channel = &check->file->channels[index];
    bool shares = false;
    LsResult result = check_channel(check, pass, index, place);
    result = result == LS_OK ? take_keys(check, pass, index, &shares) : result;
    result = result == LS_OK && !shares ? check_times(check, channel) : result;
    result = result == LS_OK ? check_values(check, channel) : result;
    if (result == LS_OK)
    {
        const float last = check->file->keys[channel->first_time + channel->key_count - 1];
        *duration = last > *duration ? last : *duration;
        pass->before = channel;
    }
    return result;
}

LsResult ls_check_animations(const LsCheck* check)
{
    const uint32_t channel_count = count_records(check, LS_CHUNK_CHANNELS);
    KeyPass pass = {.key_count = count_records(check, LS_CHUNK_KEYS)};
    uint32_t next_channel = 0;
    for (uint32_t i = 0; i < count_records(check, LS_CHUNK_ANIMATIONS); ++i)
    {
        const LsAnimation* animation = &check->file->animations[i];
        if (animation->first_channel != next_channel || animation->channel_count < 3 ||
            animation->channel_count % 3 != 0 ||
            animation->channel_count > channel_count - next_channel || animation->reserved != 0)
        {
            return ls_check_report(check, "R4.19", LS_CHUNK_ANIMATIONS, i,
                                   "%u channels from %u, the next is %u of %u; reserved 0x%x",
                                   animation->channel_count, animation->first_channel, next_channel,
                                   channel_count, animation->reserved);
        }
        float duration = 0;
        for (uint32_t place = 0; place < animation->channel_count; ++place)
        {
            const LsResult result =
                check_motion(check, &pass, next_channel + place, place, &duration);
            if (result != LS_OK)
            {
                return result;
            }
        }
        if (animation->duration != duration)
        {
            return ls_check_report(check, "R4.19", LS_CHUNK_ANIMATIONS, i,
                                   "a duration of %g, its last key is at %g",
                                   (double)animation->duration, (double)duration);
        }
        next_channel += animation->channel_count;
    }
    if (next_channel != channel_count)
    {
        return ls_check_report(check, "R4.19", LS_CHUNK_CHANNELS, next_channel,
                               "it belongs to no animation");
    }
    if (pass.next_key != pass.key_count)
    {
        return ls_check_report(check, "R4.20", LS_CHUNK_KEYS, pass.next_key,
                               "it belongs to no channel");
    }
    return LS_OK;
}

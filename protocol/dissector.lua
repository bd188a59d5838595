-- Shows Recon's packets in Wireshark: every field, whether the hash is right, and the next packet
-- behind damage, by the rules of docs/icd.md. The table above names PORT, SYNC, LIMITS, ENUMS,
-- WAYPOINT and PACKETS.

local HEADER, AROUND = 7, 9
local SYNC_TEXT = string.char(math.floor(SYNC / 256), SYNC % 256)
-- False headers may overlap. So that any capture is read in time and memory that grow with its length,
-- bytes are hashed so many times at most, on average, and behind damage only small packets are waited
-- for: telemetry, not images.
local MOST_HASHED_TIMES, MOST_AWAITED_BEHIND_DAMAGE = 32, 512
local MOST_NAMES = 8
local BYTES = { u8 = 1, i8 = 1, u16 = 2, f32 = 4, f64 = 8 }
local KINDS = {
    u8 = ProtoField.uint8,
    i8 = ProtoField.int8,
    u16 = ProtoField.uint16,
    f32 = ProtoField.float,
    f64 = ProtoField.double,
}

local recon = Proto("recon", "Recon drone interface")
recon.prefs.port = Pref.uint("TCP port", PORT, "Port on which the station listens for apps")

local frame = {
    sync = ProtoField.uint16("recon.sync", "sync", base.HEX),
    size = ProtoField.uint32("recon.size", "size (bytes)"),
    pid = ProtoField.uint8("recon.pid", "PID", base.DEC, ENUMS.pid),
    payload = ProtoField.bytes("recon.payload", "payload"),
    hash = ProtoField.uint16("recon.hash", "hash", base.HEX),
    skipped = ProtoField.bytes("recon.skipped", "bytes of no packet"),
}
local experts = {
    hash = ProtoExpert.new(
        "recon.hash.wrong", "wrong hash: the packet is damaged", expert.group.CHECKSUM,
        expert.severity.ERROR
    ),
    skipped = ProtoExpert.new(
        "recon.skipped.bytes", "bytes that belong to no packet", expert.group.MALFORMED,
        expert.severity.WARN
    ),
    given_up = ProtoExpert.new(
        "recon.given_up", "too many false headers: the rest is not searched", expert.group.MALFORMED,
        expert.severity.ERROR
    ),
    pid = ProtoExpert.new(
        "recon.pid.unknown", "a PID that the document does not have", expert.group.UNDECODED,
        expert.severity.NOTE
    ),
    value = ProtoExpert.new(
        "recon.value.unknown", "a value outside its enumeration", expert.group.PROTOCOL,
        expert.severity.NOTE
    ),
}

-- Fields of Wireshark by packet (or "waypoint") and name.
local shown = {}

local function declare(owner, field)
    local name = "recon." .. owner .. "." .. field.id
    local of = shown[owner]
    if field.type == "waypoints" then
        of[field.id] = ProtoField.none("recon.waypoint", "waypoint")
    elseif field.type == "string" then
        of["len_" .. field.id] = ProtoField.uint32(name .. ".length", field.shown .. " (bytes)")
        of[field.id] = ProtoField.string(name, field.shown, base.UNICODE)
    elseif field.type == "image" then
        of.rows = ProtoField.uint16("recon." .. owner .. ".rows", "rows")
        of.cols = ProtoField.uint16("recon." .. owner .. ".cols", "cols")
        of[field.id] = ProtoField.bytes(name, field.shown)
    elseif field.type == "rest" then
        of[field.id] = ProtoField.bytes(name, field.shown)
    elseif field.type == "f32" or field.type == "f64" then
        of[field.id] = KINDS[field.type](name, field.shown, field.doc)
    else
        of[field.id] = KINDS[field.type](
            name, field.shown, base.DEC, ENUMS[field.enum], nil, field.doc
        )
    end
end

local function declare_all()
    local all, all_experts = {}, {}
    shown.waypoint = {}
    for _, field in ipairs(WAYPOINT) do
        declare("waypoint", field)
    end
    for _, packet in pairs(PACKETS) do
        shown[packet.id] = {}
        for _, field in ipairs(packet.fields) do
            declare(packet.id, field)
        end
    end
    for _, fields in pairs(shown) do
        for _, field in pairs(fields) do
            all[#all + 1] = field
        end
    end
    for _, field in pairs(frame) do
        all[#all + 1] = field
    end
    for _, one in pairs(experts) do
        all_experts[#all_experts + 1] = one
    end
    recon.fields, recon.experts = all, all_experts
end

declare_all()

local function bytes_of(fields)
    local total = 0
    for _, field in ipairs(fields) do
        total = total + (BYTES[field.type] or 0)
    end
    return total
end

local WAYPOINT_BYTES = bytes_of(WAYPOINT)

-- Sizes that a payload may have by its last field: the least, the most, and where its own length
-- is; `exact` where the length is then known.
local function size_rule(packet)
    local head = AROUND + bytes_of(packet.fields)
    local last = packet.fields[#packet.fields]
    local most = LIMITS[last.most]
    if last.type == "string" then
        return head + 4, head + 4 + most
    elseif last.type == "image" then
        return head + 4, head + 4 + 3 * LIMITS.max_image_rows * LIMITS.max_image_cols
    elseif last.type == "rest" then
        return head, head + most
    elseif last.type == "waypoints" then
        return head + WAYPOINT_BYTES, head + WAYPOINT_BYTES * most
    end
    return head, head
end

local function number(text, at, bytes)
    local value = 0
    for i = at + 1, at + bytes do
        value = value * 256 + text:byte(i)
    end
    return value
end

-- The size that the lengths inside a payload ask for; nil, and the bytes wanted, before they are in.
local function inner_size(packet, text, at)
    local head = HEADER + bytes_of(packet.fields)
    local last = packet.fields[#packet.fields]
    if last.type ~= "string" and last.type ~= "image" then
        return nil, 0
    elseif #text - at < head + 4 then
        return nil, head + 4
    elseif last.type == "string" then
        return head + 6 + number(text, at + head, 4), 0
    end
    local rows, cols = number(text, at + head, 2), number(text, at + head + 2, 2)
    if rows > LIMITS.max_image_rows or cols > LIMITS.max_image_cols then
        return -1, 0
    end
    return head + 6 + 3 * rows * cols, 0
end

-- The size of the packet that may begin at a sync, or as much as is wanted to tell; nil if none may.
local function claim(text, at)
    if #text - at < HEADER then
        return HEADER
    end
    local size, packet = number(text, at + 2, 4), PACKETS[text:byte(at + 7)]
    if packet == nil then
        local is_possible = size >= AROUND and size <= AROUND + LIMITS.max_unknown_bytes
        return is_possible and size or nil
    end
    local least, most = size_rule(packet)
    local is_mission = packet.fields[#packet.fields].type == "waypoints"
    if size < least or size > most or (is_mission and (size - least) % WAYPOINT_BYTES ~= 0) then
        return nil
    end
    local exact, wanted = inner_size(packet, text, at)
    if exact ~= nil and exact ~= size then
        return nil
    end
    return math.max(size, wanted)
end

-- Where the next sync begins, or its first half at the end; the end without one.
local function next_sync(text, at)
    local found = text:find(SYNC_TEXT, at + 1, true)
    if found ~= nil then
        return found - 1
    elseif #text > at and text:byte(#text) == SYNC_TEXT:byte(1) then
        return #text - 1
    end
    return #text
end

local function hash_of(text, at, bytes)
    local a, b = 0, 0
    for first = at + 1, at + bytes, 100 do
        local some = { text:byte(first, math.min(first + 99, at + bytes)) }
        for i = 1, #some do
            a = a + some[i]
            b = b + a
        end
        a, b = a % 256, b % 256
    end
    return a * 256 + b
end

local function add_fields(tree, owner, fields, tvb, at, last)
    for _, field in ipairs(fields) do
        local of, size = shown[owner], BYTES[field.type]
        if field.type == "waypoints" then
            for number = 1, (last - at) / WAYPOINT_BYTES do
                local one = tree:add(of[field.id], tvb(at, WAYPOINT_BYTES))
                one:append_text(" " .. number)
                add_fields(one, "waypoint", WAYPOINT, tvb, at, at + WAYPOINT_BYTES)
                at = at + WAYPOINT_BYTES
            end
        elseif size ~= nil then
            local item = tree:add(of[field.id], tvb(at, size))
            if field.enum ~= nil and ENUMS[field.enum][tvb(at, size):uint()] == nil then
                item:add_proto_expert_info(experts.value)
            end
            at = at + size
        else
            if field.type == "string" then
                tree:add(of["len_" .. field.id], tvb(at, 4))
                at = at + 4
            elseif field.type == "image" then
                tree:add(of.rows, tvb(at, 2))
                tree:add(of.cols, tvb(at + 2, 2))
                at = at + 4
            end
            if last > at then
                tree:add(of[field.id], tvb(at, last - at))
            end
            at = last
        end
    end
end

-- Adds the packet of so many bytes; returns its name, and whether its hash is right.
local function add_packet(tvb, text, at, size, tree)
    local pid, last = text:byte(at + 7), at + size - 2
    local packet = PACKETS[pid]
    local name = packet and packet.name or "PID " .. pid
    local is_whole = hash_of(text, at, size - 2) == number(text, last, 2)
    local one = tree:add(recon, tvb(at, size))
    one:append_text(", " .. name)
    one:add(frame.sync, tvb(at, 2))
    one:add(frame.size, tvb(at + 2, 4))
    local item = one:add(frame.pid, tvb(at + 6, 1))
    if packet == nil then
        item:add_proto_expert_info(experts.pid)
    end
    -- Values of a damaged packet are not shown as if they were true.
    if packet ~= nil and is_whole then
        add_fields(one, packet.id, packet.fields, tvb, at + HEADER, last)
    elseif last > at + HEADER then
        one:add(frame.payload, tvb(at + HEADER, last - at - HEADER))
    end
    local hash = one:add(frame.hash, tvb(last, 2))
    if not is_whole then
        hash:add_proto_expert_info(experts.hash)
        one:append_text(" (damaged)")
    end
    return is_whole and name or name .. " (damaged)", is_whole
end

local function add_skipped(tvb, first, last, tree, why)
    if last > first then
        local one = tree:add(recon, tvb(first, last - first))
        one:append_text(", bytes of no packet")
        one:add(frame.skipped, tvb(first, last - first)):add_proto_expert_info(why)
    end
end

local function show_names(pinfo, names)
    local text = table.concat(names, ", ", 1, math.min(#names, MOST_NAMES))
    if #names > MOST_NAMES then
        text = text .. " and " .. #names - MOST_NAMES .. " more"
    end
    pinfo.cols.protocol = "Recon"
    if text ~= "" then
        -- More of the same segment may be told behind it.
        pinfo.cols.info = text .. " "
    end
end

-- Only the first byte of a damaged packet is given up: another may begin inside it.
function recon.dissector(tvb, pinfo, tree)
    local text, at, shown_to, names, why = tvb:raw(), 0, 0, {}, experts.skipped
    local hashable, most_awaited = MOST_HASHED_TIMES * (#text + HEADER), math.huge
    while true do
        at = next_sync(text, at)
        local size = at < #text and claim(text, at)
        local is_here = size and size <= #text - at
        if not size and at == #text then
            break
        elseif size and not is_here and size <= most_awaited then
            -- To name the bytes would call this again for each false header of the next segment.
            local is_sure = size > HEADER and most_awaited == math.huge
            local wanted = is_sure and size - (#text - at) or DESEGMENT_ONE_MORE_SEGMENT
            pinfo.desegment_offset, pinfo.desegment_len = at, wanted
            break
        elseif is_here and size > hashable then
            at, why = #text, experts.given_up
            break
        elseif is_here then
            add_skipped(tvb, shown_to, at, tree, why)
            local name, is_whole = add_packet(tvb, text, at, size, tree)
            names[#names + 1] = name
            hashable, shown_to = hashable - size, math.max(shown_to, at + size)
            at = is_whole and at + size or at + 1
            most_awaited = is_whole and most_awaited or MOST_AWAITED_BEHIND_DAMAGE
        else
            at = at + 1
        end
    end
    add_skipped(tvb, shown_to, at, tree, why)
    show_names(pinfo, names)
    return #text
end

-- On other ports: a connection is Recon's when a segment begins with a header of a possible size.
local function is_recon(tvb, pinfo, tree)
    local text = tvb:raw()
    if #text < HEADER or text:sub(1, 2) ~= SYNC_TEXT or claim(text, 0) == nil then
        return false
    end
    pinfo.conversation = recon
    recon.dissector(tvb, pinfo, tree)
    return true
end

local registered

local function listen()
    local tcp = DissectorTable.get("tcp.port")
    if registered ~= nil then
        tcp:remove(registered, recon)
    end
    registered = recon.prefs.port
    tcp:add(registered, recon)
end

listen()
recon.prefs_changed = listen
recon:register_heuristic("tcp", is_recon)

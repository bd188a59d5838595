meta:
  id: recon_drone
  title: Recon drone interface
  license: Apache-2.0
  ks-version: '0.10'
  endian: be
doc: |
  Made of recon-drone.toml by `make docs`; do not edit it here.

  The packets of one direction of a connection, or of one file of vectors/. A parser of this stops at
  damage: it knows the limits of sizes, but neither the hash nor the search for the next packet.
  docs/icd.md states both. Texts are bytes: what an app sends need not be UTF-8.
seq:
- id: packets
  type: packet
  repeat: eos
types:
  packet:
    seq:
    - id: sync
      contents:
      - 218
      - 167
    - id: size
      type: u4
      valid:
        min: 9
        max: 24883217
      doc: Bytes of the whole packet.
    - id: pid
      type: u1
      enum: pid
    - id: payload
      size: size - 9
      type:
        switch-on: pid
        cases:
          pid::core_telemetry: core_telemetry
          pid::extended_telemetry: extended_telemetry
          pid::image: image
          pid::acknowledgment: acknowledgment
          pid::message_string: message_string
          pid::compressed_image: compressed_image
          pid::virtual_stick_command: virtual_stick_command
          pid::execute_waypoint_mission: execute_waypoint_mission
          pid::camera_control: camera_control
          pid::emergency_command: emergency_command
          _: unknown_packet
    - id: hash_a
      type: u1
    - id: hash_b
      type: u1
  core_telemetry:
    seq:
    - id: is_flying
      type: u1
      enum: flying
    - id: latitude_deg
      type: f8
      -unit: °
      doc: WGS84
    - id: longitude_deg
      type: f8
      -unit: °
      doc: 'WGS84; 0 with latitude 0: position unknown'
    - id: altitude_m
      type: f8
      -unit: m
      doc: WGS84 altitude as the app knows it
    - id: height_above_takeoff_m
      type: f8
      -unit: m
      doc: barometric, above the takeoff point
    - id: velocity_north_mps
      type: f4
      -unit: m/s
    - id: velocity_east_mps
      type: f4
      -unit: m/s
    - id: velocity_down_mps
      type: f4
      -unit: m/s
      doc: positive down
    - id: yaw_deg
      type: f8
      -unit: °
      doc: 0 north, clockwise
    - id: pitch_deg
      type: f8
      -unit: °
      doc: positive nose up
    - id: roll_deg
      type: f8
      -unit: °
      doc: positive right side down
      valid:
        expr: _io.eof
  extended_telemetry:
    seq:
    - id: gnss_satellite_count
      type: u2
    - id: gnss_signal_level
      type: s1
      doc: -1 none, else 0 to 10
    - id: max_height_reached
      type: u1
      enum: reached
    - id: max_distance_reached
      type: u1
      enum: reached
    - id: battery_percent
      type: u1
      -unit: '%'
      doc: 'over 100: unknown'
    - id: battery_warning
      type: u1
      enum: battery_warning
    - id: wind_level
      type: s1
      doc: -1 unknown, else the warning level
    - id: camera_state
      type: u1
      enum: camera_state
    - id: flight_mode
      type: u1
      enum: flight_mode
    - id: mission_id
      type: u2
      doc: 0 for none; some apps always send 0
    - id: len_serial
      type: u4
      valid:
        max: 256
    - id: serial
      size: len_serial
      doc: of the drone
      valid:
        expr: _io.eof
  image:
    seq:
    - id: target_fps_hz
      type: f4
      -unit: Hz
      doc: images per second that the app aims at
    - id: rows
      type: u2
      valid:
        max: 2160
    - id: cols
      type: u2
      valid:
        max: 3840
    - id: pixels
      size: rows * cols * 3
      doc: red, green, blue of every pixel, row by row
      valid:
        expr: _io.eof
  acknowledgment:
    seq:
    - id: positive
      type: u1
      enum: answer
    - id: source_pid
      type: u1
      enum: pid
      doc: of the command
      valid:
        expr: _io.eof
  message_string:
    seq:
    - id: type
      type: u1
      enum: message_type
    - id: len_text
      type: u4
      valid:
        max: 65536
    - id: text
      size: len_text
      valid:
        expr: _io.eof
  compressed_image:
    seq:
    - id: target_fps_hz
      type: f4
      -unit: Hz
      doc: images per second that the app aims at
    - id: jpeg
      size-eos: true
      valid:
        expr: _.length <= 16777216
      doc: one JPEG file
  virtual_stick_command:
    seq:
    - id: mode
      type: u1
      enum: stick_mode
    - id: yaw_deg
      type: f4
      -unit: °
      doc: heading to hold, 0 north, clockwise
    - id: velocity_x_mps
      type: f4
      -unit: m/s
      doc: north or forward
    - id: velocity_y_mps
      type: f4
      -unit: m/s
      doc: east or right
    - id: height_above_takeoff_m
      type: f4
      -unit: m
      doc: above the takeoff point
    - id: timeout_s
      type: f4
      -unit: s
      doc: then the app sets both velocities to 0
      valid:
        expr: _io.eof
  execute_waypoint_mission:
    seq:
    - id: land_at_end
      type: u1
      enum: at_end
    - id: curved_flight
      type: u1
      enum: at_waypoints
      valid:
        expr: _io.size >= 42 and _io.size <= 3962
    - id: waypoints
      type: waypoint
      repeat: eos
  camera_control:
    seq:
    - id: action
      type: u1
      enum: camera_action
    - id: target_fps_hz
      type: f4
      -unit: Hz
      doc: images per second wanted
      valid:
        expr: _io.eof
  emergency_command:
    seq:
    - id: action
      type: u1
      enum: emergency_action
      valid:
        expr: _io.eof
  waypoint:
    seq:
    - id: latitude_deg
      type: f8
      -unit: °
      doc: WGS84
    - id: longitude_deg
      type: f8
      -unit: °
      doc: WGS84
    - id: altitude_m
      type: f8
      -unit: m
      doc: 'WGS84, or above takeoff: a setting of the app'
    - id: corner_radius_m
      type: f4
      -unit: m
      doc: of the arc that cuts the corner
    - id: speed_mps
      type: f4
      -unit: m/s
      doc: from here to the next waypoint
    - id: loiter_time_s
      type: f4
      -unit: s
      doc: NaN for none
    - id: gimbal_pitch_deg
      type: f4
      -unit: °
      doc: NaN for none
  unknown_packet:
    seq:
    - id: payload
      size-eos: true
      valid:
        expr: _.length <= 65536
enums:
  pid:
    0: core_telemetry
    1: extended_telemetry
    2: image
    3: acknowledgment
    4: message_string
    5: compressed_image
    252: virtual_stick_command
    253: execute_waypoint_mission
    254: camera_control
    255: emergency_command
  flying:
    0: not_flying
    1: flying
  reached:
    0: not_reached
    1: reached
  battery_warning:
    0: none
    1: low
    2: serious
  camera_state:
    0: not_connected
    1: feed_off
    2: feed_on
  answer:
    0: will_not_be_carried_out
    1: will_be_carried_out
  message_type:
    0: debug
    1: information
    2: warning
    3: error
  stick_mode:
    0: north_and_east
    1: forward_and_right
  at_end:
    0: hover
    1: land
  at_waypoints:
    0: stop
    1: cut_the_corner
  camera_action:
    0: stop
    1: start
    2: lock_exposure
    3: unlock_exposure
  emergency_action:
    0: hover
    1: land_now
    2: return_home_and_land
  flight_mode:
    0: manual
    1: atti
    2: atti_course_lock
    3: gps_atti
    4: gps_course_lock
    5: gps_home_lock
    6: gps_hot_point
    7: assisted_takeoff
    8: auto_takeoff
    9: auto_landing
    10: gps_waypoint
    11: go_home
    12: joystick
    13: gps_atti_wristband
    14: draw
    15: gps_follow_me
    16: active_track
    17: tap_fly
    18: gps_sport
    19: gps_novice
    20: unknown
    21: confirm_landing
    22: terrain_follow
    23: tripod
    24: active_track_spotlight
    25: motors_just_started
    255: other
